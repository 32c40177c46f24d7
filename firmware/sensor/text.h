// Numbers as text, without a C library: what lines are made of. Each function writes from `at` on and returns where it
// ended; a pointer in a structure would be loaded and stored again for every character.
#ifndef RASTERPOSE_TEXT_H
#define RASTERPOSE_TEXT_H

#include <stdint.h>

char *text_string(char *at, const char *string);

// Decimal digits, at least `width` of them.
char *text_unsigned(char *at, uint32_t value, int width);

// Hexadecimal digits in capitals, `digits` of them.
char *text_hex(char *at, uint32_t value, int digits);

// `value` x 10^-decimals, for decimals of 1 to 9: text_decimal(at, -50, 3) is -0.050.
char *text_decimal(char *at, int32_t value, int decimals);

// Right-justified in `width` places, held within what fits.
char *text_column(char *at, int32_t value, int width);

// The nearest integer of x * scale, halves away from 0; 2147483520, the largest float below 2^31, bounds it, and not a
// number is 0.
int32_t text_round(float x, float scale);

#endif
