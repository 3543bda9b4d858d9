// What    Checks that something throws a kdray::Error with a code, in one line, with a text in it.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "base/error.h"

namespace kdray::test {

template <class Action>
::testing::AssertionResult fails(Action&& action, const std::string& text,
                                 ErrorCode code = ErrorCode::input) {
  try {
    action();
  } catch (const Error& error) {
    const std::string what = error.what();
    if (error.code() != code) return ::testing::AssertionFailure() << "another code: " << what;
    if (what.find('\n') != std::string::npos) return ::testing::AssertionFailure() << "two lines: " << what;
    if (what.find(text) == std::string::npos)
      return ::testing::AssertionFailure() << "no '" << text << "' in: " << what;
    return ::testing::AssertionSuccess();
  }
  return ::testing::AssertionFailure() << "nothing was thrown";
}

}  // namespace kdray::test
