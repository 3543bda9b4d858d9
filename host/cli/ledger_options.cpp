#include "cli/ledger_options.h"

#include "base/error.h"
#include "cli/options.h"
#include "cli/parse.h"

namespace kdray::cli {

void LedgerChoice::check() const {
  if (resume && checkpoint.empty())
    throw Error(ErrorCode::usage, "--resume goes on from a ledger; say from which with --checkpoint DIR");
  if (every_given && checkpoint.empty())
    throw Error(ErrorCode::usage, "--checkpoint-every is about a ledger; add --checkpoint DIR");
}

std::optional<LedgerOptions> LedgerChoice::options() const {
  if (checkpoint.empty()) return std::nullopt;
  LedgerOptions options;
  options.folder = checkpoint;
  options.resume = resume;
  options.every_seconds = every_seconds;
  return options;
}

void add_ledger_options(CLI::App& app, LedgerChoice& choice) {
  const std::string group = "Ledger";
  add_text(app, "--checkpoint", "DIR",
           "Keep finished tiles in this folder, for a run that ends before its time",
           [&choice](const std::string& text) {
             if (text.empty()) throw usage_error("--checkpoint", text, "a folder");
             choice.checkpoint = text;
           })
      ->group(group);
  app.add_flag("--resume", choice.resume, "Go on from the tiles that are in --checkpoint's folder, if any")
      ->group(group);
  add_text(app, "--checkpoint-every", "SECONDS", "How often they are written (default 10)",
           [&choice](const std::string& text) {
             choice.every_seconds = parse_real("--checkpoint-every", text, 0.01, 1e6);
             choice.every_given = true;
           })
      ->group(group);
}

}  // namespace kdray::cli
