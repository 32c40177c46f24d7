#include "text.h"

enum { DIGITS = 10 };  // of a number of 32 bits

char *text_string(char *at, const char *string) {
    while (*string) *at++ = *string++;
    return at;
}

// Digits from the last to the first; returns where they begin. Compilers divide by the constant with a multiplication.
static char *digits_before(char *end, uint32_t value) {
    do {
        const uint32_t tenth = value / 10u;
        *--end = (char)('0' + (value - 10u * tenth));
        value = tenth;
    } while (value);
    return end;
}

static uint32_t magnitude(int32_t value) { return value < 0 ? 0u - (uint32_t)value : (uint32_t)value; }

static char *copy(char *at, const char *from, const char *end) {
    while (from < end) *at++ = *from++;
    return at;
}

char *text_unsigned(char *at, uint32_t value, int width) {
    char digits[DIGITS];
    char *const end = digits + DIGITS, *const from = digits_before(end, value);
    for (int missing = width - (int)(end - from); missing > 0; missing--) *at++ = '0';
    return copy(at, from, end);
}

char *text_hex(char *at, uint32_t value, int digits) {
    while (digits-- > 0) *at++ = "0123456789ABCDEF"[value >> 4 * digits & 15u];
    return at;
}

char *text_decimal(char *at, int32_t value, int decimals) {
    char digits[DIGITS];
    char *const end = digits + DIGITS, *const point = end - decimals;
    char *from = digits_before(end, magnitude(value));
    while (from >= point) *--from = '0';
    if (value < 0) *at++ = '-';
    at = copy(at, from, point);
    *at++ = '.';
    return copy(at, point, end);
}

char *text_column(char *at, int32_t value, int width) {
    char digits[DIGITS];
    char *const end = digits + DIGITS;
    int32_t most = 1, least = 1;
    for (int place = 0; place < width; place++) most *= 10;
    for (int place = 1; place < width; place++) least *= 10;
    if (value > most - 1) value = most - 1;
    if (value < 1 - least) value = 1 - least;
    const char *const from = digits_before(end, magnitude(value));
    for (int missing = width - (int)(end - from) - (value < 0); missing > 0; missing--) *at++ = ' ';
    if (value < 0) *at++ = '-';
    return copy(at, from, end);
}

int32_t text_round(float x, float scale) {
    const float most = 2147483520.0f;
    const float scaled = x * scale;
    if (scaled >= most) return 2147483520;
    if (scaled <= -most) return -2147483520;
    if (!(scaled > -most)) return 0;
    return (int32_t)(scaled + (scaled < 0.0f ? -0.5f : 0.5f));
}
