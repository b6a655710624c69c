/*
 * The plant's half of the processor in the loop: writes what the sensors show, reads the command, steps the plant.
 * Keeps each period's command, reference and plant outputs in the file that is named.
 */
#include "controller.h"
#include "plant.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

static plant_instance self;

static int moved(ssize_t done, size_t wanted)
{
    return (done >= 0) && ((size_t)done == wanted);
}

int main(int count, char **arguments)
{
    plant_output shown;
    plant_input command;
    controller_input sensed;
    controller_output given;
    FILE *record;
    long steps;

    if (count != 3) {
        return 2;
    }
    steps = strtol(arguments[1], NULL, 10);
    record = fopen(arguments[2], "wb");
    if ((record == NULL) || (plant_init(&self, &plant_default_parameters, &shown) != PLANT_OK)) {
        return 1;
    }
    for (long n = 0; n < steps; n++) {
        sensed.position_m = shown.measured_position_m;
        sensed.velocity_m_per_s = shown.measured_velocity_m_per_s;
        if (!moved(write(STDOUT_FILENO, &sensed, sizeof sensed), sizeof sensed)
            || !moved(read(STDIN_FILENO, &given, sizeof given), sizeof given)) {
            return 1;
        }
        command.force_n = given.force_n;
        if (plant_step(&self, &command, &shown) != PLANT_OK) {
            return 1;
        }
        (void)fwrite(&given, sizeof given, 1, record);
        (void)fwrite(&shown, sizeof shown, 1, record);
    }
    return fclose(record) == 0 ? 0 : 1;
}
