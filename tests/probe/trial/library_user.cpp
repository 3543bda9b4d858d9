// What    A program that has kdray as a library and does no trials itself: prints the devices, one a line,
//         and what is wrong with them; its argument is the folder that built programs are kept in.
#include <kdray/kdray.h>

#include <cstdio>

int main(int argc, char** argv) {
  kdray::DeviceOptions options;
  if (argc > 1) options.programs = argv[1];
  options.left_out = [](const std::string& why) { std::printf("left out: %s\n", why.c_str()); };
  for (const kdray::DeviceInfo& device : kdray::devices(options))
    std::printf("%s: %s\n", device.name.c_str(), device.usable ? "usable" : device.why_not.c_str());
  return 0;
}
