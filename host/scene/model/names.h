// What    The names that a file gives its materials and the parts that its primitives and instances are of:
//         OBJ's objects or groups, glTF's nodes, STL's solids.
// Shape   A part is runs of numbers; what has the same name is one part. Name 0 is "": none.
//         Each name is held once, and a run takes eight bytes.
// Errors  Files say what they like: names are held as printable() shows them, up to 200 bytes.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace kdray::scene {

// What comes from this number on, up to the next run, has that name.
struct NameRun {
  std::uint32_t first, name;
  bool operator==(const NameRun&) const = default;
};

struct Names {
  std::string texts;                           // one after the other: an allocation for each takes longer
  std::vector<std::uint32_t> ends;             // in them, of each name
  std::vector<std::uint32_t> materials;        // by number; shorter where the last ones have none
  std::vector<NameRun> primitives, instances;  // ascending; the last begins behind the file's last one
  bool operator==(const Names&) const = default;

  std::string_view text(std::uint32_t name) const;
  std::string_view of_material(std::uint32_t number) const;
  std::string_view of_primitive(std::uint32_t number) const;
  std::string_view of_instance(std::uint32_t number) const;
  std::uint64_t bytes() const;
};

// Collects the names while a file is read.
class NameTable {
 public:
  // Returns the name, which equal texts share; 0 where there are more than 4 GiB of them.
  std::uint32_t add(std::string_view text);
  void name_material(std::uint32_t number, std::string_view text);
  // Names what follows from a number on, which is not below those before.
  void name_primitives(std::uint32_t first, std::uint32_t name) { begin(names_.primitives, first, name); }
  void name_instances(std::uint32_t first, std::uint32_t name) { begin(names_.instances, first, name); }
  // Returns all of them, null where there are none; primitives and instances end before these numbers.
  std::shared_ptr<const Names> finish(std::uint32_t n_primitives, std::uint32_t n_instances);

 private:
  static void begin(std::vector<NameRun>& runs, std::uint32_t first, std::uint32_t name);

  std::uint32_t& place_of(std::string_view text);
  void grow();

  Names names_;
  std::vector<std::uint32_t> table_;  // names by their hashes, 0: free; at most half of it is used
};

}  // namespace kdray::scene
