// Clocks of floating-point operations of which each needs the result of the one before, as in a polynomial.
#include "program.h"

#define STRING(text) #text
#define TEXT(text) STRING(text)
#define LENGTH 64  // of a chain

// `operands` follow the result register, which is the first operand too. The move waits for the last result.
#define CHAIN(function, instruction, operands)                                                                \
    __attribute__((noinline)) static uint32_t function(void) {                                                \
        float x = 1.5f;                                                                                       \
        const float y = 0.75f;                                                                                \
        const uint32_t before = platform_clocks();                                                            \
        __asm__ volatile(".rept " TEXT(LENGTH) "\n\t" instruction " %0, %0" operands "\n\t.endr\n\tmv %0, %0" \
                         : "+r"(x)                                                                            \
                         : "r"(y));                                                                           \
        return platform_clocks() - before;                                                                    \
    }

CHAIN(add, "fadd.s", ", %1")
CHAIN(subtract, "fsub.s", ", %1")
CHAIN(multiply, "fmul.s", ", %1")
CHAIN(divide, "fdiv.s", ", %1")
CHAIN(root, "fsqrt.s", "")
CHAIN(sign, "fsgnj.s", ", %1")
CHAIN(sign_not, "fsgnjn.s", ", %1")
CHAIN(sign_xor, "fsgnjx.s", ", %1")
CHAIN(least, "fmin.s", ", %1")
CHAIN(most, "fmax.s", ", %1")
CHAIN(not_above, "fle.s", ", %1")
CHAIN(below, "flt.s", ", %1")
CHAIN(equal, "feq.s", ", %1")
CHAIN(classify, "fclass.s", "")
CHAIN(to_integer, "fcvt.w.s", ", rtz")
CHAIN(from_integer, "fcvt.s.w", "")

struct operation {
    char name[12];
    uint32_t (*chain)(void);
};

// Volatile, or the compiler would leave nothing of it, and the host reads the names.
const volatile struct operation operations[] = {
    {"fadd", add},   {"fsub", subtract},   {"fmul", multiply},       {"fdiv", divide},
    {"fsqrt", root}, {"fsgnj", sign},      {"fsgnjn", sign_not},     {"fsgnjx", sign_xor},
    {"fmin", least}, {"fmax", most},       {"fle", not_above},       {"flt", below},
    {"feq", equal},  {"fclass", classify}, {"fcvt.w.s", to_integer}, {"fcvt.s.w", from_integer},
};

enum { OPERATIONS = sizeof operations / sizeof operations[0] };

uint32_t clocks[OPERATIONS];  // of a chain, and of reading the clock
uint32_t length;              // of a chain
uint32_t empty_clocks;        // that the two readings of the clock take between themselves

void measure(void) {
    length = LENGTH;
    for (int number = 0; number < OPERATIONS; number++) {
        operations[number].chain();  // fills the cache
        clocks[number] = operations[number].chain();
    }
    const uint32_t before = platform_clocks();
    empty_clocks = platform_clocks() - before;
}
