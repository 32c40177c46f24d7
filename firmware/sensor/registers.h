// Where the registers are. Their structures and masks are made from hdl/registers.rdl.
#ifndef RASTERPOSE_REGISTERS_H
#define RASTERPOSE_REGISTERS_H

#include "rasterpose_regs.h"

#define SYSTEM ((volatile rasterpose_system_t *)0xF0000000u)

#endif
