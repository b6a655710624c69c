#include "semihosting.h"

enum { SYS_OPEN = 0x01, SYS_WRITE = 0x05, SYS_READ = 0x06, SYS_EXIT_EXTENDED = 0x20 };
enum { READ_BYTES = 1, WRITE_BYTES = 5 };

static int32_t input = -1;
static int32_t output = -1;

static int32_t call(uint32_t operation, const void *arguments)
{
    register uint32_t r0 __asm("r0") = operation;
    register const void *r1 __asm("r1") = arguments;
    __asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
    return (int32_t)r0;
}

static int32_t opened(const char *name, uint32_t length, uint32_t mode)
{
    const uint32_t arguments[3] = { (uint32_t)name, mode, length };
    return call(SYS_OPEN, arguments);
}

/* Reads or writes; returns how many bytes are left, 0 if none. */
static uint32_t moved(uint32_t operation, int32_t file, uint32_t bytes, uint32_t count)
{
    const uint32_t arguments[3] = { (uint32_t)file, bytes, count };
    return (uint32_t)call(operation, arguments);
}

void host_open(void)
{
    input = opened("/dev/stdin", 10u, READ_BYTES);
    output = opened("/dev/stdout", 11u, WRITE_BYTES);
    if ((input < 0) || (output < 0)) {
        exit(98);
    }
}

bool host_read(void *bytes, uint32_t count)
{
    uint32_t left = count;
    while (left > 0u) {
        const uint32_t next = moved(SYS_READ, input, (uint32_t)bytes + (count - left), left);
        if (next >= left) {
            break;
        }
        left = next;
    }
    return left == 0u;
}

void host_write(const void *bytes, uint32_t count)
{
    uint32_t left = count;
    while (left > 0u) {
        const uint32_t next = moved(SYS_WRITE, output, (uint32_t)bytes + (count - left), left);
        if (next >= left) {
            exit(97);
        }
        left = next;
    }
}

void exit(int status)
{
    /* 0x20026: the application ended; the second word is its status. */
    const uint32_t arguments[2] = { 0x20026u, (uint32_t)status };
    for (;;) {
        (void)call(SYS_EXIT_EXTENDED, arguments);
    }
}
