#include "engine/checkpoint/leases.h"

#include <algorithm>
#include <charconv>
#include <string_view>
#include <system_error>
#include <utility>

#include "engine/checkpoint/create_once.h"

namespace kdray::checkpoint {

namespace fs = std::filesystem;

namespace {

constexpr const char* kDone = "done";
constexpr std::size_t kLongestOwner = 128;

// A number at the text's beginning, which is taken from it; false: there is none.
template <class Number>
bool take_number(std::string_view& text, Number& number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc()) return false;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return true;
}

}  // namespace

Leases::Leases(fs::path folder, std::string name, std::size_t first, std::size_t n, Heartbeat& heartbeat)
    : folder_(std::move(folder)), name_(std::move(name)), first_(first), heartbeat_(heartbeat), things_(n) {}

fs::path Leases::file_of(std::size_t i, const std::string& ending) const {
  return folder_ / (name_ + "-" + std::to_string(first_ + i) + "." + ending);
}

void Leases::read_name(const std::string& name) {
  std::string_view rest = name;
  std::size_t number = 0;
  if (!rest.starts_with(name_ + "-")) return;
  rest.remove_prefix(name_.size() + 1);
  if (!take_number(rest, number) || number < first_ || number - first_ >= things_.size() ||
      !rest.starts_with('.'))
    return;
  rest.remove_prefix(1);
  Thing& thing = things_[number - first_];
  std::uint32_t lease = 0;
  if (rest == kDone) thing.done = true;
  if (take_number(rest, lease) && rest.empty()) thing.next = std::max(thing.next, lease + 1);
}

// A lease that was taken over is another's, although this process may still be at work.
void Leases::find_owner(std::size_t i, std::map<std::string, bool>& alive) {
  Thing& thing = things_[i];
  thing.held = false;
  if (thing.next == 0 || thing.done) return;
  const std::uint32_t last = thing.next - 1;
  if (thing.owner_of != last || thing.owner.empty())
    thing.owner = read_small(file_of(i, std::to_string(last)), kLongestOwner), thing.owner_of = last;
  thing.mine = thing.owner == heartbeat_.owner();
  const auto [found, is_new] = alive.try_emplace(thing.owner, true);
  if (is_new) found->second = heartbeat_.is_alive(thing.owner);
  thing.held = found->second;
}

void Leases::look() {
  std::error_code error;
  for (fs::directory_iterator entry(folder_, error), end; !error && entry != end; entry.increment(error))
    read_name(entry->path().filename().string());
  std::map<std::string, bool> alive;  // each is asked once
  for (std::size_t i = 0; i < things_.size(); ++i) find_owner(i, alive);
}

std::size_t Leases::n_done() const {
  return static_cast<std::size_t>(std::ranges::count_if(things_, [](const Thing& t) { return t.done; }));
}

bool Leases::claim(std::size_t i) {
  Thing& thing = things_[i];
  const bool got = create_once(file_of(i, std::to_string(thing.next)), heartbeat_.owner());
  thing.held = true;
  thing.mine = got;
  if (got) {
    thing.owner = heartbeat_.owner();
    thing.owner_of = thing.next;
  }
  ++thing.next;
  return got;
}

bool Leases::finish(std::size_t i) {
  things_[i].done = true;
  things_[i].mine = things_[i].held = false;
  return create_once(file_of(i, kDone), heartbeat_.owner());
}

}  // namespace kdray::checkpoint
