// The functions that compilers call on their own, to copy and to clear. By words where all is aligned.

#include <stddef.h>
#include <stdint.h>

void *memcpy(void *restrict to, const void *restrict from, size_t count);
void *memmove(void *to, const void *from, size_t count);
void *memset(void *to, int value, size_t count);

// May alias anything, as what these functions copy is of any type.
typedef uint32_t __attribute__((may_alias)) word;

static int aligned(const void *one, const void *other) { return (((uintptr_t)one | (uintptr_t)other) & 3) == 0; }

// From the first byte on, so that it is also right for what overlaps with to before from.
static void copy_up(unsigned char *to, const unsigned char *from, size_t count) {
    if (aligned(to, from)) {
        for (; count >= 4; count -= 4, to += 4, from += 4) *(word *)to = *(const word *)from;
    }
    for (; count; count--) *to++ = *from++;
}

void *memcpy(void *restrict to, const void *restrict from, size_t count) {
    copy_up(to, from, count);
    return to;
}

void *memmove(void *to, const void *from, size_t count) {
    if ((uintptr_t)to - (uintptr_t)from >= count) {
        copy_up(to, from, count);
    } else {
        unsigned char *end = (unsigned char *)to + count;
        const unsigned char *source = (const unsigned char *)from + count;
        for (; count; count--) *--end = *--source;
    }
    return to;
}

void *memset(void *to, int value, size_t count) {
    unsigned char *at = to;
    uint32_t pattern = (unsigned char)value * UINT32_C(0x01010101);
    if (aligned(to, to)) {
        for (; count >= 4; count -= 4, at += 4) *(word *)at = pattern;
    }
    for (; count; count--) *at++ = (unsigned char)value;
    return to;
}
