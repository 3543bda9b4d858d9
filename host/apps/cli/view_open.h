// What    Opens the page in the user's browser, and tells when nobody is there any more who could see or end
//         the server.
#pragma once

#include <memory>
#include <string>

#include "base/temporary.h"

namespace kdray::cli {

// Whether there is a screen here, and somebody at a terminal.
bool can_open();

// By way of a file that only this user can read: the command lines of programs are for all to see, and the
// address has the token. The file goes with what is returned; null: there is no program that opens pages.
std::unique_ptr<Temporary> open_in_browser(const std::string& address);

// Of standard input and standard error, where they lead to somebody (a terminal, a pipe) at first.
class Company {
 public:
  Company();
  bool is_gone() const;

 private:
  bool watch_in_, watch_err_;
};

}  // namespace kdray::cli
