//! acosf and atanf as the C library of `ziglang` has them: it carries musl's, rewritten in Zig, in its standard library.

const math = @import("std").math;

export fn acosf(x: f32) callconv(.c) f32 {
    return math.acos(x);
}

export fn atanf(x: f32) callconv(.c) f32 {
    return math.atan(x);
}
