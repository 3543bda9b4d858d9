// What    The most that options of several benches may ask for.
#pragma once

namespace kdray::cli {

inline constexpr int kRaysMax = 1 << 26;  // of a class
inline constexpr int kRepeatMax = 100000;
inline constexpr int kSideMax = 65536;  // of a picture, across or down
inline constexpr long long kPixelsMax = 1 << 26;

}  // namespace kdray::cli
