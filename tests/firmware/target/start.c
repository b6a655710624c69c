/* What a Cortex-M4F needs before main: the vector table, the FPU switched on, data and zeros in place. */
#include <stdint.h>

extern uint32_t data_start, data_end, data_image, bss_start, bss_end;

int main(void);
void exit(int status) __attribute__((noreturn));
void reset(void);
void stack_top(void); /* no function: the linker script names the address */

/* Only newlib's semihosting has it: opens stdin, stdout and stderr. */
void initialise_monitor_handles(void) __attribute__((weak));

#define COPROCESSOR_ACCESS (*(volatile uint32_t *)0xE000ED88u)

void reset(void)
{
    uint32_t *from = &data_image;
    uint32_t *to;

    COPROCESSOR_ACCESS |= 0xFu << 20;
    __asm volatile("dsb\n isb" ::: "memory");
    for (to = &data_start; to < &data_end; to++) {
        *to = *from;
        from++;
    }
    for (to = &bss_start; to < &bss_end; to++) {
        *to = 0u;
    }
    if (initialise_monitor_handles != 0) {
        initialise_monitor_handles();
    }
    exit(main());
}

/* NMI, hard fault, and every fault that is not enabled: they escalate to the hard fault. */
static void fault(void)
{
    exit(99);
}

__attribute__((section(".vectors"), used)) static void (*const vectors[4])(void) = {
    stack_top, reset, fault, fault
};

/* newlib's exit calls it where there is one; there is nothing to end. */
void _fini(void);
void _fini(void)
{
}
