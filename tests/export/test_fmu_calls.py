"""Bad calls of FMUs are refused with a message, under AddressSanitizer and UBSan."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest
from tests.export.units import VERSIONS, Exported, paper

pytestmark = pytest.mark.slow

COMMON = r"""
#include "fmu.c"
#include <stdio.h>

static int messages = 0;
static int faults = 0;
static char last[300];

#define REFUSED(call) wanted((int)(call), 3, #call)
#define DISCARDED(call) wanted((int)(call), 2, #call)
#define GOOD(call) wanted((int)(call), 0, #call)

static int before = 0;

static void wanted(int status, int expected, const char *call)
{
    const int silent = (messages == before) && (strstr(call, "(NULL") == NULL);
    if ((status != expected) || ((expected != 0) && silent)) {
        printf("%s: %d, %d messages more: %s\n", call, status, messages - before, last);
        faults++;
    }
    before = messages;
}
"""

FMI2 = r"""
static void logger(void *e, fmi2String name, fmi2Status s, fmi2String c, fmi2String text, ...)
{
    (void)e; (void)name; (void)s; (void)c;
    messages++;
    strncpy(last, text, sizeof last - 1u);
}

int main(void)
{
    fmi2CallbackFunctions f = {logger, NULL, NULL, NULL, NULL};
    fmi2ValueReference r, many[2] = {FIRST_PARAMETER, 4000000000u};
    double x = NAN, values[2] = {0};
    int whole = -1;
    size_t size = 0;
    void *state = NULL, *other = NULL;
    char bytes[8] = {0};
    if (fmi2Instantiate("a", fmi2CoSimulation, "wrong", "", &f, 0, 0) != NULL) { faults++; }
    if (fmi2Instantiate("a", fmi2ModelExchange, TOKEN, "", &f, 0, 0) != NULL) { faults++; }
    if (fmi2Instantiate(NULL, fmi2CoSimulation, TOKEN, "", &f, 0, 0) != NULL) { faults++; }
    if (fmi2Instantiate("a", fmi2CoSimulation, NULL, NULL, &f, 0, 0) != NULL) { faults++; }
    if (fmi2Instantiate("a", fmi2CoSimulation, TOKEN, "", NULL, 0, 0) != NULL) { faults++; }
    if (messages != 4) { faults++; printf("%d messages\n", messages); }
    fmi2Component c = fmi2Instantiate("a", fmi2CoSimulation, TOKEN, NULL, &f, 0, 0);
    before = messages;
    REFUSED(fmi2DoStep(NULL, 0, 1e-5, 0));
    REFUSED(fmi2GetReal(NULL, &r, 1, &x));
    REFUSED(fmi2Reset(NULL));
    fmi2FreeInstance(NULL);
    REFUSED(fmi2DoStep(c, 0, 1e-5, 0));
    REFUSED(fmi2ExitInitializationMode(c));
    REFUSED(fmi2Terminate(c));
    REFUSED(fmi2SetupExperiment(c, 0, 0, NAN, 0, 0));
    REFUSED(fmi2SetupExperiment(c, 0, 0, 1, 1, 0.5));
    r = FIRST_PARAMETER;
    REFUSED(fmi2SetReal(c, &r, 1, &x));
    x = -1.0;
    REFUSED(fmi2SetReal(c, &r, 1, &x));
    REFUSED(fmi2SetReal(c, NULL, 1, &x));
    REFUSED(fmi2SetReal(c, &r, 1, NULL));
    REFUSED(fmi2GetReal(c, many, 2, values));
    r = FIRST_OUTPUT;
    REFUSED(fmi2SetReal(c, &r, 1, &x));
    r = TIME;
    REFUSED(fmi2SetReal(c, &r, 1, &x));
    r = FIRST_SEED;
    REFUSED(fmi2SetReal(c, &r, 1, &x));
    REFUSED(fmi2GetReal(c, &r, 1, &x));
    REFUSED(fmi2SetInteger(c, &r, 1, &whole));
    r = FIRST_PARAMETER;
    REFUSED(fmi2GetInteger(c, &r, 1, &whole));
    r = FIRST_INPUT;
    x = NAN;
    REFUSED(fmi2SetReal(c, &r, 1, &x));
    x = 1e300;
    REFUSED(fmi2SetReal(c, &r, 1, &x));
    REFUSED(fmi2GetBoolean(c, &r, 1, &whole));
    REFUSED(fmi2GetDirectionalDerivative(c, &r, 1, &r, 1, &x, &x));
    REFUSED(fmi2CancelStep(c));
    GOOD(fmi2SetBoolean(c, NULL, 0, NULL));
    GOOD(fmi2SetupExperiment(c, 0, 0, 0, 1, 1e-3));
    GOOD(fmi2EnterInitializationMode(c));
    REFUSED(fmi2EnterInitializationMode(c));
    GOOD(fmi2ExitInitializationMode(c));
    DISCARDED(fmi2DoStep(c, 0, 1.5e-5, 0));
    if (strstr(last, "control_period_s = 1e-5 s") == NULL) { faults++; puts(last); }
    DISCARDED(fmi2DoStep(c, 0, 0.0, 0));
    DISCARDED(fmi2DoStep(c, 0, -1e-5, 0));
    DISCARDED(fmi2DoStep(c, 0, NAN, 0));
    DISCARDED(fmi2DoStep(c, 0, 1e300, 0));
    REFUSED(fmi2DoStep(c, 1.0, 1e-5, 0));
    REFUSED(fmi2DoStep(c, NAN, 1e-5, 0));
    REFUSED(fmi2DoStep(c, 0, 2e-3, 0));
    GOOD(fmi2DoStep(c, 0, 1e-5, 0));
    r = PERIOD;
    x = 2e-5;
    REFUSED(fmi2SetReal(c, &r, 1, &x));
    REFUSED(fmi2GetFMUstate(c, NULL));
    GOOD(fmi2GetFMUstate(c, &state));
    GOOD(fmi2GetFMUstate(c, &state));
    REFUSED(fmi2SetFMUstate(c, NULL));
    GOOD(fmi2SerializedFMUstateSize(c, state, &size));
    REFUSED(fmi2SerializedFMUstateSize(c, NULL, &size));
    REFUSED(fmi2SerializeFMUstate(c, state, bytes, sizeof bytes));
    REFUSED(fmi2DeSerializeFMUstate(c, bytes, sizeof bytes, &other));
    GOOD(fmi2FreeFMUstate(c, &state));
    GOOD(fmi2FreeFMUstate(c, &state));
    GOOD(fmi2Terminate(c));
    REFUSED(fmi2DoStep(c, 1e-5, 1e-5, 0));
    r = FIRST_PARAMETER;
    REFUSED(fmi2SetReal(c, &r, 1, &x));
    GOOD(fmi2Reset(c));
    fmi2FreeInstance(c);
    f.logger = NULL;
    c = fmi2Instantiate("quiet", fmi2CoSimulation, TOKEN, NULL, &f, 0, 0);
    (void)fmi2DoStep(c, 0, 1, 0);
    fmi2FreeInstance(c);
    return faults;
}
"""

FMI3 = r"""
static void logger(void *e, fmi3Status s, fmi3String c, fmi3String text)
{
    (void)e; (void)s; (void)c;
    messages++;
    strncpy(last, text, sizeof last - 1u);
}

static fmi3Instance
made(const char *name, const char *token, bool events, fmi3LogMessageCallback say)
{
    return fmi3InstantiateCoSimulation(
        name, token, NULL, false, false, events, false, NULL, 0, NULL, say, NULL);
}

int main(void)
{
    fmi3ValueReference r, many[2] = {FIRST_PARAMETER, 4000000000u};
    double x = NAN, at = 0.0, values[2] = {0};
    uint64_t whole = 1;
    int32_t small = 1;
    size_t size = 0;
    bool a, b, e;
    void *state = NULL, *other = NULL;
    uint8_t bytes[8] = {0};
    if (made("a", "wrong", false, logger) != NULL) { faults++; }
    if (made("a", NULL, false, logger) != NULL) { faults++; }
    if (made(NULL, TOKEN, false, logger) != NULL) { faults++; }
    if (made("a", TOKEN, true, logger) != NULL) { faults++; }
    if (made("a", "wrong", false, NULL) != NULL) { faults++; }
    if (fmi3InstantiateModelExchange("a", TOKEN, "", false, false, NULL, logger) != NULL) {
        faults++;
    }
    if (messages != 5) { faults++; printf("%d messages\n", messages); }
    fmi3Instance c = made("a", TOKEN, false, logger);
    before = messages;
    REFUSED(fmi3DoStep(NULL, 0, 1e-5, false, &a, &b, &e, &at));
    REFUSED(fmi3GetFloat64(NULL, &r, 1, &x, 1));
    REFUSED(fmi3Reset(NULL));
    fmi3FreeInstance(NULL);
    REFUSED(fmi3DoStep(c, 0, 1e-5, false, &a, &b, &e, &at));
    REFUSED(fmi3ExitInitializationMode(c));
    REFUSED(fmi3Terminate(c));
    REFUSED(fmi3EnterInitializationMode(c, false, 0, NAN, false, 0));
    REFUSED(fmi3EnterInitializationMode(c, false, 0, 1.0, true, 0.5));
    r = FIRST_PARAMETER;
    REFUSED(fmi3SetFloat64(c, &r, 1, &x, 1));
    x = -1.0;
    REFUSED(fmi3SetFloat64(c, &r, 1, &x, 1));
    REFUSED(fmi3SetFloat64(c, &r, 1, &x, 2));
    REFUSED(fmi3SetFloat64(c, NULL, 1, &x, 1));
    REFUSED(fmi3SetFloat64(c, &r, 1, NULL, 1));
    REFUSED(fmi3GetFloat64(c, many, 2, values, 2));
    REFUSED(fmi3GetUInt64(c, &r, 1, &whole, 1));
    r = FIRST_OUTPUT;
    REFUSED(fmi3SetFloat64(c, &r, 1, &x, 1));
    r = FIRST_SEED;
    REFUSED(fmi3GetFloat64(c, &r, 1, &x, 1));
    GOOD(fmi3SetUInt64(c, &r, 1, &whole, 1));
    REFUSED(fmi3GetInt32(c, &r, 1, &small, 1));
    GOOD(fmi3GetInt32(c, NULL, 0, NULL, 0));
    r = FIRST_INPUT;
    x = NAN;
    REFUSED(fmi3SetFloat64(c, &r, 1, &x, 1));
    x = 1e300;
    REFUSED(fmi3SetFloat64(c, &r, 1, &x, 1));
    REFUSED(fmi3GetDirectionalDerivative(c, &r, 1, &r, 1, &x, 1, &x, 1));
    REFUSED(fmi3EnterEventMode(c));
    REFUSED(fmi3EnterConfigurationMode(c));
    GOOD(fmi3EnterInitializationMode(c, false, 0, 0, true, 1e-3));
    REFUSED(fmi3EnterInitializationMode(c, false, 0, 0, true, 1e-3));
    GOOD(fmi3ExitInitializationMode(c));
    REFUSED(fmi3DoStep(c, 0, 1e-5, false, NULL, &b, &e, &at));
    DISCARDED(fmi3DoStep(c, 0, 1.5e-5, false, &a, &b, &e, &at));
    if (strstr(last, "control_period_s = 1e-5 s") == NULL) { faults++; puts(last); }
    DISCARDED(fmi3DoStep(c, 0, NAN, false, &a, &b, &e, &at));
    DISCARDED(fmi3DoStep(c, 0, 1e300, false, &a, &b, &e, &at));
    REFUSED(fmi3DoStep(c, 1.0, 1e-5, false, &a, &b, &e, &at));
    REFUSED(fmi3DoStep(c, 0, 2e-3, false, &a, &b, &e, &at));
    GOOD(fmi3DoStep(c, 0, 1e-5, false, &a, &b, &e, &at));
    if (at != 1e-5) { faults++; }
    r = FIRST_SEED;
    REFUSED(fmi3SetUInt64(c, &r, 1, &whole, 1));
    REFUSED(fmi3GetFMUState(c, NULL));
    GOOD(fmi3GetFMUState(c, &state));
    REFUSED(fmi3SetFMUState(c, NULL));
    GOOD(fmi3SerializedFMUStateSize(c, state, &size));
    REFUSED(fmi3SerializeFMUState(c, state, bytes, sizeof bytes));
    REFUSED(fmi3DeserializeFMUState(c, bytes, sizeof bytes, &other));
    GOOD(fmi3FreeFMUState(c, &state));
    GOOD(fmi3Terminate(c));
    REFUSED(fmi3DoStep(c, 1e-5, 1e-5, false, &a, &b, &e, &at));
    GOOD(fmi3Reset(c));
    fmi3FreeInstance(c);
    c = made("quiet", TOKEN, false, NULL);
    (void)fmi3Terminate(c);
    fmi3FreeInstance(c);
    return faults;
}
"""


@pytest.mark.parametrize("fmi", VERSIONS)
def test_bad_calls_are_refused(fmi: str, tmp_path: Path) -> None:
    folder = Exported(paper(), "plant", fmi, tmp_path).folder / "sources"
    (folder / "calls.c").write_text(COMMON + (FMI2 if fmi == "2" else FMI3))
    compiler = shutil.which("gcc")
    if compiler is None:
        pytest.skip("needs gcc")
    command = [compiler, "-std=c99", "-g", "-O1", "-ffp-contract=off"]
    command += ["-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
    (folder / "none.c").write_text("int main(void) { return 0; }\n")
    tried = subprocess.run(
        [*command, "none.c", "-o", "none"], cwd=folder, capture_output=True, check=False
    )
    if tried.returncode != 0:
        pytest.skip("needs the sanitizers")
    done = subprocess.run(
        [*command, "calls.c", "plant.c", "-lm", "-o", "calls"],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    run = subprocess.run([folder / "calls"], capture_output=True, text=True, check=False)
    assert (run.returncode, run.stdout) == (0, ""), run.stdout + run.stderr
