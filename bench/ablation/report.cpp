#include "bench/ablation/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/measure/short_name.h"
#include "bench/plot/svg.h"

namespace kdray::bench {

namespace {

double millions(std::uint64_t n) {
  return 1e-6 * static_cast<double>(n);
}

std::string picture_words(const AblationRow& row) {
  if (row.n_differing == 0) return "same bits";
  return fmt::format("{} values, by {:.2g}{}", row.n_differing, row.largest_difference,
                     row.ablation.exact ? " (!)" : "");
}

Json json_of(const AblationRow& row) {
  return {{"without", row.ablation.name},
          {"kind", name_of(row.ablation.kind)},
          {"exact", row.ablation.exact},
          {"seconds", json_of(row.seconds)},
          {"ratio", json_of(row.ratio)},
          {"compile_seconds", row.compile_seconds ? Json(*row.compile_seconds) : Json()},
          {"rays", row.rays},
          {"differing_values", row.n_differing},
          {"largest_difference", row.largest_difference}};
}

Json json_of(const AblationRun& run) {
  Json json = {{"scene", run.scene},
               {"device", run.device},
               {"primitives", run.n_primitives},
               {"features", {{"on", run.on}, {"off", run.off}}},
               {"rows", Json::array()}};
  for (const AblationRow& row : run.rows) json["rows"].push_back(json_of(row));
  return json;
}

// ---- The plot: bars from 1 to the right, or to the left where taking something away made the frame faster.

constexpr double kLeft = 330, kRight = 90, kHead = 84, kTitle = 34, kBar = 17, kFoot = 44, kWidth = 900;

const char* color_of(const Ablation& a) {
  if (a.kind == Ablation::Kind::specialisation) return "#4477aa";
  if (a.kind == Ablation::Kind::everything) return "#444444";
  return a.exact ? "#228833" : "#ee6677";
}

class ScenePanel {
 public:
  ScenePanel(const AblationRun& run, double top) : run_(run), top_(top) {
    for (const AblationRow& row : run.rows) {
      lo_ = std::min(lo_, row.ratio.min);
      hi_ = std::max(hi_, row.ratio.max);
    }
  }

  double height() const { return kTitle + kBar * static_cast<double>(run_.rows.size() - 1) + kFoot; }

  std::string draw() const {
    const double first = top_ + kTitle, last = first + kBar * static_cast<double>(run_.rows.size() - 1);
    std::string out = svg::text(
        kLeft, top_ + 18, 13, "start",
        fmt::format("{}, {:.3g} ms", short_name(run_.scene), 1e3 * run_.rows.front().seconds.median),
        " font-weight=\"bold\"");
    for (const double v : {0.5, 0.8, 1.0, 1.25, 1.5, 2.0, 3.0, 5.0, 10.0, 20.0, 50.0, 100.0})
      if (v >= lo_ && v <= hi_)
        out += svg::line(x(v), first, x(v), last, v == 1.0 ? "#333333" : "#dddddd") +
               svg::text(x(v), last + 15, 10, "middle", fmt::format("{:g}", v));
    for (std::size_t i = 1; i < run_.rows.size(); ++i)
      out += bar(run_.rows[i], first + kBar * static_cast<double>(i - 1));
    return out;
  }

 private:
  double x(double ratio) const {
    return kLeft + (kWidth - kLeft - kRight) * std::log(ratio / lo_) / std::log(hi_ / lo_);
  }

  std::string bar(const AblationRow& row, double y) const {
    const double at = x(row.ratio.median), one = x(1), middle = y + kBar / 2;
    return svg::text(kLeft - 10, middle + 4, 11, "end", row.ablation.name) +
           svg::rectangle(std::min(at, one), y + 2, std::max(std::abs(at - one), 1.0), kBar - 4,
                          color_of(row.ablation)) +
           svg::line(x(row.ratio.min), middle, x(row.ratio.max), middle, "#333333") +
           svg::text(std::max(x(row.ratio.max), one) + 6, middle + 4, 10, "start",
                     fmt::format("{:.2f}", row.ratio.median));
  }

  const AblationRun& run_;
  double top_;
  double lo_ = 0.8, hi_ = 1.25;
};

std::string legend() {
  static const std::pair<Ablation, const char*> kEntries[] = {
      {{.name = {}, .kind = Ablation::Kind::specialisation}, "code that isn't needed compiled in"},
      {{.name = {}, .kind = Ablation::Kind::rule}, "an exact rule off"},
      {{.name = {}, .kind = Ablation::Kind::rule, .exact = false}, "a rule that changes the picture off"},
      {{.name = {}, .kind = Ablation::Kind::everything}, "everything exact"}};
  std::string out;
  double at = 24;
  for (const auto& [ablation, words] : kEntries) {
    out += svg::rectangle(at, 58, 12, 12, color_of(ablation)) + svg::text(at + 18, 68, 11, "start", words);
    at += 44 + 11 * svg::kTextWidth * static_cast<double>(std::string(words).size());
  }
  return out;
}

}  // namespace

std::string table_of(const AblationRun& run) {
  std::string out =
      fmt::format("{}: {} primitives\n  {:<40}{:>10}{:>9}{:>11}{:>11}  {}\n", short_name(run.scene),
                  run.n_primitives, "without", "ms", "x", "M rays", "compile s", "picture");
  for (const AblationRow& row : run.rows)
    out += fmt::format("  {:<40}{:>10.2f}{:>9.3f}{:>11.3f}{:>11}  {}\n", row.ablation.name,
                       1e3 * row.seconds.median, row.ratio.median, millions(row.rays.at("total")),
                       row.compile_seconds ? fmt::format("{:.2f}", *row.compile_seconds) : "-",
                       picture_words(row));
  return out;
}

Json json_of(std::span<const AblationRun> runs, const AblationOptions& options) {
  Json json = {{"command", "bench ablation"},    {"size", {options.width, options.height}},
               {"depth", options.depth},         {"repeat", options.repeat},
               {"inexact", count_inexact(runs)}, {"runs", Json::array()}};
  for (const AblationRun& run : runs) json["runs"].push_back(json_of(run));
  return json;
}

std::string plot_of(std::span<const AblationRun> runs, const AblationOptions& options) {
  std::string body = svg::text(24, 24, 15, "start", "A frame's time without one thing, over its usual time",
                               " font-weight=\"bold\"") +
                     svg::text(24, 42, 11, "start",
                               fmt::format("{}; {}x{}, depth {}; medians of {} rounds, least and most",
                                           runs.empty() ? "" : runs.front().device, options.width,
                                           options.height, options.depth, options.repeat),
                               " fill=\"#555\"") +
                     legend();
  double top = kHead;
  for (const AblationRun& run : runs) {
    const ScenePanel panel(run, top);
    body += panel.draw();
    top += panel.height();
  }
  return svg::document(kWidth, top, body);
}

}  // namespace kdray::bench
