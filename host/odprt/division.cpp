#include "odprt/division.h"

#include "odprt/deal.h"

namespace kdray::odprt {

std::vector<std::uint32_t> Division::subtrees_of(std::uint32_t part) const {
  std::vector<std::uint32_t> subtrees;
  for (std::uint32_t i = 0; i < part_of.size(); ++i)
    if (part_of[i] == part) subtrees.push_back(i);
  return subtrees;
}

Division divide(const flatten::FlatScene& scene, const flatten::WideForm& form, const Cut& cut,
                std::span<const double> costs, std::uint32_t n_parts, double spare) {
  std::vector<std::uint64_t> bytes;
  double all_bytes = 0;
  for (const Subtree& subtree : cut.subtrees) {
    bytes.push_back(subtree.bytes);
    all_bytes += static_cast<double>(subtree.bytes);
  }
  Division division;
  division.part_of =
      deal(costs, bytes, n_parts, static_cast<std::uint64_t>((1.0 / n_parts + spare) * all_bytes));
  division.directory = make_directory(form, cut, division.part_of);
  if (n_parts == 1) {
    division.parts.push_back({scene, form, 0});  // nothing to take apart
    return division;
  }
  division.parts = make_parts(scene, form, cut, division.part_of, n_parts);
  return division;
}

}  // namespace kdray::odprt
