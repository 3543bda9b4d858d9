// What    Which names and tokens let somebody in.
#include <gtest/gtest.h>

#include <set>

#include "apps/view/http.h"

namespace kdray::view {
namespace {

TEST(Token, Is128BitsThatDiffer) {
  std::set<std::string> seen;
  for (int i = 0; i < 1000; ++i) seen.insert(Token().text());
  EXPECT_EQ(seen.size(), 1000u);
  const Token token;
  EXPECT_EQ(token.text().size(), 32u);
  EXPECT_EQ(token.text().find_first_not_of("0123456789abcdef"), std::string::npos);
  EXPECT_TRUE(token.is(token.text()));
  for (std::size_t i = 0; i < 32; ++i) {
    std::string other = token.text();
    other[i] = other[i] == '0' ? '1' : '0';
    EXPECT_FALSE(token.is(other)) << i;
  }
  EXPECT_FALSE(token.is(""));
  EXPECT_FALSE(token.is(token.text() + "0"));
}

TEST(Names, OfTheLoopbackAtAnyPort) {
  const Names names("127.0.0.1");
  for (const char* const host :
       {"127.0.0.1", "127.0.0.1:1", "localhost:65535", "LocalHost", "[::1]:8080", "[::1]"})
    EXPECT_TRUE(names.allow_host(host)) << host;
  for (const char* const host : {"",
                                 "evil.example",
                                 "localhost.evil.example",
                                 "127.0.0.1.evil.example",
                                 "evil.example:7878",
                                 "127.0.0.2",
                                 "127.0.0.1:",
                                 "127.0.0.1:x",
                                 "127.0.0.1:123456",
                                 "localhost:80:80",
                                 "[::1",
                                 "[::1]x",
                                 "[::2]",
                                 "::1",
                                 "2130706433",
                                 "localhost ",
                                 " localhost",
                                 "localhost\t",
                                 "a@localhost",
                                 "localhost/",
                                 "0.0.0.0"})
    EXPECT_FALSE(names.allow_host(host)) << host;
  EXPECT_FALSE(names.allow_host(std::string(300, 'a')));
}

TEST(Names, OfWhatItIsBoundTo) {
  EXPECT_TRUE(Names("192.168.1.5").allow_host("192.168.1.5:7878"));
  EXPECT_FALSE(Names("192.168.1.5").allow_host("192.168.1.6:7878"));
  EXPECT_TRUE(Names("fe80::1").allow_host("[fe80::1]:7878"));
  // Of all addresses: numbers can't be rebound, names can.
  EXPECT_TRUE(Names("0.0.0.0").allow_host("10.1.2.3:7878"));
  EXPECT_TRUE(Names("::").allow_host("[2001:db8::1]:7878"));
  EXPECT_FALSE(Names("0.0.0.0").allow_host("evil.example:7878"));
}

TEST(Names, OriginIsThePageItself) {
  const Names names("127.0.0.1");
  EXPECT_TRUE(names.allow_origin("http://localhost:8080", "localhost:8080"));
  EXPECT_TRUE(names.allow_origin("https://localhost:8080", "localhost:8080"));
  for (const char* const origin :
       {"", "null", "http://localhost", "http://127.0.0.1:8080", "http://evil.example",
        "http://localhost:8081", "ftp://localhost:8080", "http://localhost:8080.evil.example"})
    EXPECT_FALSE(names.allow_origin(origin, "localhost:8080")) << origin;
  EXPECT_FALSE(names.allow_origin("http://evil.example", "evil.example"));
}

TEST(Cookie, IsFoundByItsWholeName) {
  EXPECT_EQ(cookie_in("a=1; kdray-x=2; b=3", "kdray-x"), "2");
  EXPECT_EQ(cookie_in("kdray-x=2", "kdray-x"), "2");
  EXPECT_EQ(cookie_in("xkdray-x=2; kdray-xy=3", "kdray-x"), "");
  EXPECT_EQ(cookie_in("", "kdray-x"), "");
  EXPECT_EQ(cookie_in(";;;=;kdray-x", "kdray-x"), "");
}

TEST(Address, Loopback) {
  EXPECT_TRUE(is_loopback("127.0.0.1") && is_loopback("::1") && is_loopback("127.5.0.1"));
  EXPECT_FALSE(is_loopback("0.0.0.0") || is_loopback("192.168.0.1") || is_loopback("127.evil.example"));
}

}  // namespace
}  // namespace kdray::view
