// What a measuring program is: `main` is in program.c, and calls `measure` once.
//
// Its inputs are a constant object that the host patches into the image (firmware.toolchain.image), its results are
// variables that the host reads when the program has said "done".
#ifndef RASTERPOSE_PROGRAM_H
#define RASTERPOSE_PROGRAM_H

#include "platform.h"

// Makes an object one of the inputs. What it is initialised with is not what it holds, so the compiler must see no more
// than its declaration where it is used: it is defined in a file of its own.
#define INPUT __attribute__((section(".settings"), used))

// The program's own.
void measure(void);

#endif
