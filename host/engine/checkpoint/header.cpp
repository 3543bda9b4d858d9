#include "engine/checkpoint/header.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <type_traits>

#include "base/error.h"

namespace kdray::checkpoint {

namespace {

static_assert(std::endian::native == std::endian::little, "checkpoints are in the machine's own order");

constexpr std::array<char, 8> kHeaderMagic = {'k', 'd', 'r', 'a', 'y', 'l', 'e', 'd'};
constexpr std::uint32_t kVersion = 1;  // of the form of checkpoints

struct Fixed {
  std::array<char, 8> magic;
  std::uint32_t version, bytes;
  Hash scene, settings, build;
  Cut cut;
  std::array<char, 256> settings_text, build_text, maker;
  std::array<char, 160> spare;
  Hash check;  // of all before it
};
static_assert(sizeof(Fixed) == kHeaderBytes && std::is_trivially_copyable_v<Fixed>);

Hash header_check(const Fixed& fixed) {
  return hash_of(&fixed, offsetof(Fixed, check));
}

template <std::size_t kN>
void put(std::array<char, kN>& to, const std::string& text) {
  std::copy_n(text.begin(), std::min(text.size(), kN - 1), to.begin());
}

template <std::size_t kN>
std::string text_of(const std::array<char, kN>& from) {
  return {from.begin(), std::find(from.begin(), from.end(), '\0')};
}

}  // namespace

Rectangle places_of(const Cut& cut, std::uint32_t round, std::uint32_t number) {
  if (round > 0) return {number * KDRAY_SAMPLE_RUN, 0, KDRAY_SAMPLE_RUN, 1};
  const std::uint32_t x = KDRAY_TILE_COLUMN(number) * cut.tile_width,
                      y = KDRAY_TILE_ROW(number) * cut.tile_height;
  if (x >= cut.width || y >= cut.height) return {};
  return {x, y, std::min(cut.tile_width, cut.width - x), std::min(cut.tile_height, cut.height - y)};
}

Hash Header::frame() const {
  const struct {
    Hash scene, settings, build;
    Cut cut;
  } all{identity.scene, identity.settings, identity.build, cut};
  return hash_of(&all, sizeof all);
}

std::string to_bytes(const Header& header) {
  Fixed fixed{};
  fixed.magic = kHeaderMagic;
  fixed.version = kVersion;
  fixed.bytes = kHeaderBytes;
  fixed.scene = header.identity.scene;
  fixed.settings = header.identity.settings;
  fixed.build = header.identity.build;
  fixed.cut = header.cut;
  put(fixed.settings_text, header.identity.settings_text);
  put(fixed.build_text, header.identity.build_text);
  put(fixed.maker, header.maker);
  fixed.check = header_check(fixed);
  return {reinterpret_cast<const char*>(&fixed), sizeof fixed};
}

std::optional<Header> header_of(std::string_view bytes) {
  if (bytes.size() < kHeaderBytes) return std::nullopt;
  Fixed fixed;
  std::memcpy(&fixed, bytes.data(), sizeof fixed);
  if (fixed.magic != kHeaderMagic || fixed.version != kVersion || fixed.check != header_check(fixed))
    return std::nullopt;
  return Header{.identity = {fixed.scene, fixed.settings, fixed.build, text_of(fixed.settings_text),
                             text_of(fixed.build_text)},
                .cut = fixed.cut,
                .maker = text_of(fixed.maker)};
}

void check_same(const std::filesystem::path& folder, const Identity& checkpoint, const Identity& run) {
  const auto refuse = [&](const std::string& what) {
    throw input_error(folder.string(), 0, "the checkpoint in this folder is of " + what,
                      "name another folder, or remove this one");
  };
  if (checkpoint.build != run.build)
    refuse(
        checkpoint.build_text == run.build_text
            ? fmt::format("another build of kdray ({})", run.build_text)
            : fmt::format("another kdray or driver ({}; this is {})", checkpoint.build_text, run.build_text));
  if (checkpoint.scene != run.scene) refuse("another scene");
  if (checkpoint.settings != run.settings)
    refuse(checkpoint.settings_text == run.settings_text
               ? fmt::format("another view or other settings ({})", run.settings_text)
               : fmt::format("other settings ({}; here they are {})", checkpoint.settings_text,
                             run.settings_text));
}

}  // namespace kdray::checkpoint
