/* Reads an input, steps the controller, writes its output, until the input ends. */
#include "controller.h"
#include "semihosting.h"

static controller_instance self;

int main(void)
{
    controller_input input;
    controller_output output;

    host_open();
    if (controller_init(&self, &controller_default_parameters) != CONTROLLER_OK) {
        return 1;
    }
    while (host_read(&input, sizeof input)) {
        (void)controller_step(&self, &input, &output);
        host_write(&output, sizeof output);
    }
    return 0;
}
