// What    What of a page's messages is taken, and that everything else is refused.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "apps/view/message.h"
#include "apps/view/served.h"
#include "kdray/error.h"

namespace kdray::view {
namespace {

using Json = nlohmann::json;

void refuses(const std::string& text) {
  EXPECT_THROW(parse_message(text), Error) << text;
}

TEST(Message, ALookIsTakenAsItIs) {
  Json json = Json::parse(test::kLook);
  json["sight"]["samples"] = 16;
  json["sight"]["channel"] = "cost";
  json["sight"]["mode"] = "odprt";
  json["sight"]["look"] = "plain";
  json["sight"]["traversal"] = "batch";
  json["sight"]["camera"]["from"] = {0.1, -1e-9, 3e200};
  const Look look = std::get<Look>(parse_message(json.dump()));
  EXPECT_EQ(look.number, 1u);
  EXPECT_TRUE(look.moving);
  EXPECT_EQ(look.request.camera.from, (Vec3{0.1, -1e-9, 3e200}));
  EXPECT_EQ(look.request.width, 64);
  EXPECT_EQ(look.request.samples, Samples::number);
  EXPECT_EQ(look.request.n_samples, 16);
  EXPECT_EQ(look.request.channel, "cost");
  EXPECT_EQ(look.request.mode, Mode::odprt);
  EXPECT_EQ(look.request.look, kdray::Look::plain);
  EXPECT_EQ(look.request.traversal, Traversal::batch);
  EXPECT_EQ(std::get<Shown>(parse_message(R"({"type":"shown","frame":7})")).frame, 7u);
  EXPECT_EQ(std::get<Cells>(parse_message(R"({"type":"cells","scene":0,"depth":9})")).depth, 9);
  EXPECT_EQ(std::get<Smooth>(parse_message(R"({"type":"smooth","scene":0,"degrees":40})")).degrees, 40);
  refuses(R"({"type":"smooth","scene":0,"degrees":181})");
  refuses(R"({"type":"smooth","scene":0})");
}

// Each field left out, of another type, and out of range.
TEST(Message, EveryFieldIsChecked) {
  const Json good = Json::parse(test::kLook);
  const std::vector<std::string> places = {"/type",
                                           "/number",
                                           "/moving",
                                           "/sight",
                                           "/sight/scene",
                                           "/sight/camera",
                                           "/sight/camera/from",
                                           "/sight/camera/at",
                                           "/sight/camera/up",
                                           "/sight/camera/fov",
                                           "/sight/camera/ortho",
                                           "/sight/width",
                                           "/sight/height",
                                           "/sight/depth",
                                           "/sight/samples",
                                           "/sight/weight",
                                           "/sight/headlight",
                                           "/sight/channel",
                                           "/sight/mode",
                                           "/sight/traversal",
                                           "/sight/queues"};
  for (const std::string& place : places) {
    const Json::json_pointer at(place);
    Json without = good;
    without[at.parent_pointer()].erase(at.back());
    refuses(without.dump());
    for (const Json& wrong :
         {Json(nullptr), Json("x"), Json(-1e9), Json(1e9), Json(Json::array({1})), Json::object()}) {
      if (wrong == 1e9 && (place == "/number" || place == "/sight/camera/ortho")) continue;  // all right
      Json changed = good;
      changed[at] = wrong;
      refuses(changed.dump());
    }
  }
  for (const Json& wrong : {Json("bright"), Json(1), Json(Json::array())}) {
    Json changed = good;
    changed["sight"]["look"] = wrong;
    refuses(changed.dump());
  }
  Json more = good;
  more["sight"]["path"] = "/etc/passwd";
  refuses(more.dump());
}

TEST(Message, WhatIsTooLargeOrNoJson) {
  refuses("");
  refuses("{");
  refuses("[]");
  refuses("null");
  refuses(std::string(2000, '['));
  refuses(R"({"type":"shown","frame":1)" + std::string(kMostText, ' ') + "}");
  Json json = Json::parse(test::kLook);
  json["sight"]["width"] = 4096;
  json["sight"]["height"] = 4096;
  refuses(json.dump());
  refuses(R"({"type":"shown","frame":1.5})");
  refuses(R"({"type":"shown","frame":4294967296})");
  refuses(R"({"type":"shown","frame":1,"frame2":1})");
  EXPECT_THROW(token_of_hello(R"({"type":"hello"})"), Error);
  EXPECT_THROW(token_of_hello(R"({"type":"hello","token":1})"), Error);
  EXPECT_EQ(token_of_hello(R"({"type":"hello","token":"a"})"), "a");
}

}  // namespace
}  // namespace kdray::view
