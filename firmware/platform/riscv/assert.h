// Of C11's <assert.h> what compilers alone can do: freestanding ones do not bring it, and the register header wants it.
#ifndef RASTERPOSE_ASSERT_H
#define RASTERPOSE_ASSERT_H

#define static_assert _Static_assert

#endif
