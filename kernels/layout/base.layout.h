// What    What every shared struct needs: fixed-width names and size checks for both compilers.
// Shape   Structs that cross between host and device live in kernels/layout/*.layout.h and nowhere else:
//         scalars of fixed width and arrays of them, indices for addresses, padding spelled out and zero.
#ifndef KDRAY_LAYOUT_BASE_H
#define KDRAY_LAYOUT_BASE_H

// Goes into every file or message that holds these bytes; raise it with any change of a struct.
#define KDRAY_LAYOUT_VERSION 5

#ifdef __OPENCL_C_VERSION__

typedef uint u32;
typedef int i32;
typedef ulong u64;
typedef uchar u8;
typedef long i64;
#define KDRAY_LAYOUT_BEGIN
#define KDRAY_LAYOUT_END
// OpenCL C 1.2 has no static_assert: an array of negative size fails the build instead.
#define KDRAY_ASSERT_SIZE(type, bytes) typedef char kdray_size_of_##type[sizeof(type) == (bytes) ? 1 : -1];
#define KDRAY_ASSERT_OFFSET(type, field, bytes) \
  typedef char kdray_offset_of_##type##_##field[__builtin_offsetof(type, field) == (bytes) ? 1 : -1];

#else

#include <cstddef>
#include <cstdint>
#include <type_traits>
#define KDRAY_LAYOUT_BEGIN   \
  namespace kdray::layout {  \
  using u8 = std::uint8_t;   \
  using u32 = std::uint32_t; \
  using i32 = std::int32_t;  \
  using u64 = std::uint64_t; \
  using i64 = std::int64_t;
#define KDRAY_LAYOUT_END }
#define KDRAY_ASSERT_SIZE(type, bytes)                                                                  \
  static_assert(                                                                                        \
      sizeof(type) == (bytes) && std::is_standard_layout_v<type> && std::is_trivially_copyable_v<type>, \
      #type " has changed its size: kernels/layout is a contract with the kernels");
#define KDRAY_ASSERT_OFFSET(type, field, bytes) \
  static_assert(offsetof(type, field) == (bytes), #type "." #field " has moved");

#endif
#endif
