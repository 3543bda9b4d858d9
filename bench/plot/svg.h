// What    The few elements of SVG that plots are made of, as text.
#pragma once

#include <string>

namespace kdray::bench::svg {

inline constexpr double kTextWidth = 0.6;  // of a letter in font sizes, at the most

std::string text(double x, double y, double size, const std::string& anchor, const std::string& what,
                 const std::string& more = "");
std::string line(double x0, double y0, double x1, double y1, const std::string& color);
std::string rectangle(double x, double y, double width, double height, const std::string& color);
std::string circle(double x, double y, double radius, const std::string& color);

// A whole file with a white background.
std::string document(double width, double height, const std::string& body);

// The next of 1, 2, 5, 10, ... such that about five steps make up `range`.
double step_for(double range);

}  // namespace kdray::bench::svg
