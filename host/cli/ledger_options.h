// What    The options of render on ledgers: --checkpoint --resume --checkpoint-every.
// Errors  kdray::Error, ErrorCode::usage: options that don't go together.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "kdray/options.h"

namespace kdray::cli {

struct LedgerChoice {
  std::string checkpoint;  // the folder; empty: no ledger
  bool resume = false, every_given = false;
  double every_seconds = LedgerOptions().every_seconds;

  void check() const;
  std::optional<LedgerOptions> options() const;
};

void add_ledger_options(CLI::App& app, LedgerChoice& choice);

}  // namespace kdray::cli
