/* Files of the host and the end of the run, by Arm semihosting: a breakpoint that the emulator serves. */
#ifndef SEMIHOSTING_H
#define SEMIHOSTING_H

#include <stdbool.h>
#include <stdint.h>

/** Standard input and output of the emulator, opened for bytes. */
void host_open(void);

/** Reads so many bytes, waiting for them. Returns false at the end of the input. */
bool host_read(void *bytes, uint32_t count);

/** Writes so many bytes; a write that fails ends the run. */
void host_write(const void *bytes, uint32_t count);

/** Ends the emulator with this status. */
void exit(int status) __attribute__((noreturn));

#endif
