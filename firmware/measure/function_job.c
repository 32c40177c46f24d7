#include "function_job.h"

#include "program.h"

INPUT const struct job job = {.count = 1};
