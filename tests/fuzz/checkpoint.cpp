// A file of finished tiles: the header, then for each block of the input a record, whose checksums are made
// right where the block's first byte is even, so that what the head says is believed; else the block's bytes
// as they are.
#include "engine/checkpoint/record_file.h"
#include "fuzz/records.h"
#include "fuzz/target.h"

KDRAY_FUZZ(checkpoint, bytes) {
  using namespace kdray;
  const checkpoint::Header header{.identity = {}, .cut = {64, 48, 8, 8}, .maker = "fuzz"};
  const Hash frame = header.frame();
  fuzz::Input input(bytes);
  std::string content;
  const auto n_records = input.take<std::uint8_t>() % 8;
  if (n_records % 2 == 0) content = checkpoint::to_bytes(header);
  for (int i = 0; i < n_records; ++i) {
    const bool right = input.take<std::uint8_t>() % 2 == 0;
    const std::string_view record = input.block();
    content += right ? fuzz::with_checksums(record, frame) : std::string(record);
  }
  content += input.rest();

  static const fuzz::MemoryFile file;
  file.put(content);
  checkpoint::RecordFile records(file.path(), frame);
  std::size_t n_read = 0;
  records.read_on([&](const checkpoint::RecordHead& head, std::uint64_t offset, checkpoint::Sums sums) {
    ++n_read;
    std::vector<layout::i64> again(sums.size());
    if (offset + sums.size_bytes() > content.size()) fuzz::fail("a record behind the file's end");
    if (!records.load(offset, head.content, again)) fuzz::fail("a record that can't be read again");
  });
  return n_read > 0;
}
