#include "apps/cli/suggestion.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "base/error.h"

namespace kdray::cli {

namespace {

struct OtherWord {
  std::string_view word, ours;
};

// Options of other renderers and viewers, and what they are here.
constexpr OtherWord kOtherWords[] = {
    {"width", "--size WxH"},
    {"height", "--size WxH"},
    {"resolution", "--size WxH"},
    {"res", "--size WxH"},
    {"dimensions", "--size WxH"},
    {"geometry", "--size WxH"},
    {"w", "--size WxH"},
    {"W", "--size WxH"},
    {"H", "--size WxH"},
    {"spp", "--samples"},
    {"antialias", "--samples"},
    {"antialiasing", "--samples"},
    {"anti-aliasing", "--samples"},
    {"aa", "--samples"},
    {"max-depth", "--depth"},
    {"bounces", "--depth"},
    {"max-bounces", "--depth"},
    {"recursion", "--depth"},
    {"out", "--output"},
    {"outfile", "--output"},
    {"eye", "--from"},
    {"position", "--from"},
    {"camera-position", "--from"},
    {"lookfrom", "--from"},
    {"look-from", "--from"},
    {"lookat", "--at"},
    {"look-at", "--at"},
    {"target", "--at"},
    {"camera-target", "--at"},
    {"focal-point", "--at"},
    {"camera-focal-point", "--at"},
    {"up-axis", "--up"},
    {"view-up", "--up"},
    {"camera-view-up", "--up"},
    {"angle", "--fov"},
    {"view-angle", "--fov"},
    {"camera-view-angle", "--fov"},
    {"field-of-view", "--fov"},
    {"zoom", "--fov"},
    {"orthographic", "--ortho"},
    {"bg", "--background"},
    {"bg-color", "--background"},
    {"background-color", "--background"},
    {"no-background", "--background transparent"},
    {"transparent", "--background transparent"},
    {"alpha", "--background transparent"},
    {"gpu", "--device gpu"},
    {"cpu", "--device cpu"},
    {"channels", "--aov"},
    {"passes", "--aov"},
    {"normals", "--aov normal"},
    {"seconds", "--time"},
    {"animation-time", "--time"},
    {"framerate", "--fps"},
    {"silent", "--quiet"},
};

std::string_view without_dashes(std::string_view word) {
  return word.substr(std::min(word.find_first_not_of('-'), word.size()));
}

// Returns our option for another program's, where the command has it; nothing otherwise.
std::string_view counterpart(std::string_view word, const std::vector<std::string>& names) {
  const auto* const found = std::ranges::find(kOtherWords, without_dashes(word), &OtherWord::word);
  if (!word.starts_with('-') || found == std::end(kOtherWords)) return {};
  const std::string_view option = found->ours.substr(0, found->ours.find(' '));
  return std::ranges::find(names, option) == names.end() ? std::string_view() : found->ours;
}

}  // namespace

std::string suggestion(const std::string& word, const std::vector<std::string>& names) {
  if (const std::string_view ours = counterpart(word, names); !ours.empty())
    return fmt::format("did you mean '{}'? ", ours);
  const bool is_option = word.starts_with("--");
  std::vector<std::string_view> comparable;
  for (const std::string& name : names)
    if (name.starts_with("--") == is_option) comparable.push_back(without_dashes(name));
  const std::string_view nearest = nearest_name(without_dashes(word), comparable);
  return nearest.empty() ? "" : fmt::format("did you mean '{}{}'? ", is_option ? "--" : "", nearest);
}

}  // namespace kdray::cli
