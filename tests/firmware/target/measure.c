/*
 * Steps a controller through STEPS inputs and gives back every output, and how many instructions each step took.
 * Every EPISODE steps it is reset.
 *
 * Under `-icount shift=0` an instruction takes 1 ns of the emulator's time, and SysTick counts 25 MHz: 40
 * instructions a tick. So each step is run TIMES = 120 times from the same state, and an empty function as often:
 * the difference in ticks, 3 for each instruction, is off by less than 1, and rounds to the exact count.
 */
#include "controller.h"
#include "semihosting.h"

enum { STEPS = 10000, TIMES = 120, TICKS_PER_INSTRUCTION = 3 };

typedef controller_status (*step_function)(controller_instance *, const controller_input *, controller_output *);

static controller_instance self;
static controller_input inputs[STEPS];
static controller_output outputs[STEPS];
static uint16_t instructions[STEPS];

#define SYSTICK_CONTROL (*(volatile uint32_t *)0xE000E010u)
#define SYSTICK_RELOAD (*(volatile uint32_t *)0xE000E014u)
#define SYSTICK_VALUE (*(volatile uint32_t *)0xE000E018u)

/* One instruction: the return that a step has too. */
__attribute__((naked)) static controller_status nothing(
    controller_instance *instance, const controller_input *input, controller_output *output)
{
    (void)instance;
    (void)input;
    (void)output;
    __asm volatile("bx lr");
}

/* Ticks of TIMES calls from the same state, and what it takes to call. The compiler may not know the function. */
__attribute__((noipa)) static uint32_t ticks(step_function step, const controller_input *input)
{
    const controller_state before = self.state;
    controller_output output;
    const uint32_t start = SYSTICK_VALUE;
    for (uint32_t n = 0u; n < TIMES; n++) {
        self.state = before;
        (void)step(&self, input, &output);
    }
    const uint32_t stop = SYSTICK_VALUE;
    self.state = before;
    return (start - stop) & 0xFFFFFFu;
}

static uint16_t instructions_of_a_step(const controller_input *input)
{
    const uint32_t spent = ticks(controller_step, input) - ticks(nothing, input);
    return (uint16_t)(1u + ((spent + 1u) / TICKS_PER_INSTRUCTION));
}

int main(void)
{
    host_open();
    if (!host_read(inputs, sizeof inputs) || (controller_init(&self, &controller_default_parameters) != CONTROLLER_OK)) {
        return 1;
    }
    SYSTICK_RELOAD = 0xFFFFFFu;
    SYSTICK_VALUE = 0u;
    SYSTICK_CONTROL = 5u; /* on, with the processor's clock */
    for (uint32_t n = 0u; n < STEPS; n++) {
        if ((n % EPISODE) == 0u) {
            controller_reset(&self);
        }
        instructions[n] = instructions_of_a_step(&inputs[n]);
        (void)controller_step(&self, &inputs[n], &outputs[n]);
    }
    host_write(outputs, sizeof outputs);
    host_write(instructions, sizeof instructions);
    return 0;
}
