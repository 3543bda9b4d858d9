// What    Opens the page in the user's browser, and tells when the terminal or pipe is closed by which the
//         user could see or end the server.
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

// Tells whether standard input or standard error has been closed, where it led to a terminal or a pipe at
// first.
class StdioMonitor {
 public:
  StdioMonitor();
  bool is_closed() const;

 private:
  bool watches_in_, watches_err_;
};

}  // namespace kdray::cli
