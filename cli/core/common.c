/* The options that every command takes. */
#include "cli.h"

#include <string.h>

void cli_common_options(cli_option options[CLI_COMMON_OPTIONS], cli_common *common) {
    const cli_option made[CLI_COMMON_OPTIONS] = {
        {"--device", 0, "SPEC", "auto, cpu, gpu, reference, an index or a name (else TIDES_DEVICE)", NULL, &common->device,
         NULL},
        {"--threads", 0, "N", "of the host, and of a CPU's driver; 0: as many as there are processors (else TIDES_THREADS)",
         NULL, &common->threads, NULL},
        {"--json", 0, NULL, "facts as JSON, alone on standard output", &common->json, NULL, NULL},
        {"--quiet", 'q', NULL, "say nothing but errors, and what --json prints", &common->quiet, NULL, NULL},
        {"--verbose", 'v', NULL, "say what is being done", &common->verbose, NULL, NULL},
        {"--help", 'h', NULL, "this text", &common->help, NULL, NULL},
    };
    memcpy(options, made, sizeof made);
}
