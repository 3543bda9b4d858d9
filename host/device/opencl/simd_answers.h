// What    The answers that every form of common/simd.clh must give, made on the host one lane at a time; and
//         the cases of the self-test at start.
#pragma once

#include <string>
#include <vector>

#include "layout/simd_test.layout.h"

namespace kdray::device {

layout::SimdAnswers expected_answers(const layout::SimdCase& given);

// The cases are every pair of NaN, infinities, zeros of both signs, limits and common numbers, in every lane,
// and every mask of 8 lanes.
std::vector<layout::SimdCase> known_cases();

// The first operation whose answer differs by a bit ("pack16 of case 3"); empty when none does.
std::string first_difference(const std::vector<layout::SimdCase>& cases,
                             const std::vector<layout::SimdAnswers>& answers);

}  // namespace kdray::device
