// What    kdray compare: how far two pictures are apart.
#include <fmt/format.h>

#include <limits>
#include <memory>
#include <string>

#include "apps/cli/command.h"
#include "apps/cli/options.h"
#include "apps/cli/output.h"
#include "apps/cli/run_files.h"
#include "apps/cli/stats.h"
#include "base/error.h"
#include "io/image/compare.h"
#include "io/image/picture_file.h"

namespace kdray::cli {

namespace {

struct CompareArgs {
  std::string a, b, diff;
  image::Transfer transfer;
  double max_rmse = -1;  // < 0: no limit
  bool json = false;
};

std::string as_text(const image::Difference& d) {
  return fmt::format(
      "RMSE            {:.6g}\n"
      "mean absolute   {:.6g}\n"
      "largest         {:.6g}\n"
      "differing       {:.4g} % of the pixels by more than 1/255\n"
      "FLIP            {:.6g}\n",
      d.rmse, d.mean_absolute, d.max, d.differing_share * 100, d.flip);
}

std::string as_json(const image::Difference& d) {
  const Json json = {{"rmse", d.rmse},
                     {"mean_absolute", d.mean_absolute},
                     {"max", d.max},
                     {"differing_share", d.differing_share},
                     {"flip", d.flip}};
  return json.dump(2) + "\n";
}

int run(const CompareArgs& o) {
  RunFiles files;
  files.read("A", o.a);
  files.read("B", o.b);
  for (const std::string& file : {o.a, o.b})
    if (file == "-")
      throw Error(ErrorCode::usage, "'-': compare reads files; write the picture to one first");
  if (o.diff == "-")
    throw Error(ErrorCode::usage, "--diff '-': the figures go to standard output; name a file");
  files.write_picture("--diff", o.diff, {}, {});
  const image::Image a = image::read_picture(o.a, o.transfer);
  const image::Image b = image::read_picture(o.b, o.transfer);
  if (a.width != b.width || a.height != b.height)
    throw input_error(o.b, 0,
                      fmt::format("is {}x{}, but {} is {}x{}", b.width, b.height, o.a, a.width, a.height),
                      "render both with the same --size");
  const image::Difference d = image::compare(a, b);
  if (!o.diff.empty()) image::write_picture(o.diff, image::difference_image(a, b), {}, {});
  print(o.json ? as_json(d) : as_text(d));
  // Written so that a NaN, which is below nothing, fails too.
  if (o.max_rmse >= 0 && !(d.rmse <= o.max_rmse)) {
    say(fmt::format("{}: differs from {} by an RMSE of {:.6g}, more than {:.6g}", o.b, o.a, d.rmse,
                    o.max_rmse));
    return static_cast<int>(ErrorCode::input);
  }
  return 0;
}

}  // namespace

Command add_compare(CLI::App& kdray) {
  CLI::App* const app = kdray.add_subcommand("compare", "Tell how far two pictures are apart");
  const auto o = std::make_shared<CompareArgs>();
  app->add_option("A", o->a, "A picture, .png or .exr")->required()->type_name("");
  app->add_option("B", o->b, "Another of the same size")->required()->type_name("");
  add_path(*app, "--diff", "Write a heat map of the differences, .png or .exr", o->diff);
  add_text(*app, "--gamma", "srgb|G", "PNG's transfer curve, as for render: srgb (default) or v^(1/G)",
           [o = o.get()](const std::string& text) { o->transfer = parse_gamma("--gamma", text); });
  add_real(*app, "--max-rmse", "X", "Exit with 1 when the RMSE is above X", 0,
           std::numeric_limits<double>::max(), o->max_rmse);
  app->add_flag("--json", o->json, "Print JSON");
  return {app, [o] { return run(*o); }};
}

}  // namespace kdray::cli
