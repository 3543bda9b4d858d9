// Must not compile with KDRAY_TEST_BYTES=16: the struct has 12 bytes. (With 12 it must.)
#include "layout/base.layout.h"
KDRAY_LAYOUT_BEGIN
typedef struct Wrong {
  float a[3];
} Wrong;
KDRAY_ASSERT_SIZE(Wrong, KDRAY_TEST_BYTES)
KDRAY_LAYOUT_END
