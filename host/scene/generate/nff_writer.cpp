// What    The NFF entities as lines of text.
#include "scene/generate/nff_writer.h"

#include <array>
#include <charconv>
#include <cmath>
#include <ostream>

namespace kdray::generate {

namespace {

constexpr int kDigits = 9;
constexpr double kNoise = 1e-12;

}  // namespace

// std::to_chars writes a decimal point whatever the locale; a stream's << might write a comma.
void NffWriter::number(double value) {
  if (std::abs(value) < kNoise) value = 0;
  std::array<char, 32> text;
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, kDigits);
  if (!line_.empty()) line_ += ' ';
  line_.append(text.data(), end.ptr);
}

void NffWriter::vector(const dvec3& v) {
  number(v.x);
  number(v.y);
  number(v.z);
}

void NffWriter::end_line() {
  line_ += '\n';
  out_.write(line_.data(), static_cast<std::streamsize>(line_.size()));
  line_.clear();
}

void NffWriter::background(const dvec3& color) {
  line_ = "b";
  vector(color);
  end_line();
}

void NffWriter::view(const View& v) {
  line_ = "v\nfrom";
  vector(v.from);
  line_ += "\nat";
  vector(v.at);
  line_ += "\nup";
  vector(v.up);
  line_ += "\nangle";
  number(v.angle);
  line_ += "\nhither";
  number(v.hither);
  line_ += "\nresolution";
  number(v.resolution);
  number(v.resolution);
  end_line();
}

void NffWriter::light(const dvec3& position) {
  line_ = "l";
  vector(position);
  end_line();
}

void NffWriter::surface(const Surface& s) {
  line_ = "f";
  vector(s.color);
  number(s.diffuse);
  number(s.specular);
  number(s.shine);
  number(s.transmit);
  number(s.index);
  end_line();
}

void NffWriter::sphere(const dvec3& center, double radius) {
  line_ = "s";
  vector(center);
  number(radius);
  end_line();
}

void NffWriter::cone(const dvec3& base, double base_radius, const dvec3& apex, double apex_radius) {
  line_ = "c";
  vector(base);
  number(base_radius);
  vector(apex);
  number(apex_radius);
  end_line();
}

void NffWriter::polygon(std::span<const dvec3> vertices) {
  line_ = "p";
  number(static_cast<double>(vertices.size()));
  end_line();
  for (const dvec3& v : vertices) {
    vector(v);
    end_line();
  }
}

void NffWriter::patch(std::span<const PatchVertex> vertices) {
  line_ = "pp";
  number(static_cast<double>(vertices.size()));
  end_line();
  for (const PatchVertex& v : vertices) {
    vector(v.position);
    vector(v.normal);
    end_line();
  }
}

}  // namespace kdray::generate
