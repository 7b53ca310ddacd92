// Drawings of assignment 4: discrete events, the faults of two engines, messages, active pairs,
// groups.
#include <algorithm>
#include <string>

#include "handouts/drawings/drawing.h"

namespace tumble::handouts {
namespace {

const Pen kAxis{color::soft, 1.2};

Drawing discrete_events() {
  Drawing d(640, 220);
  // The state of one process: constant parts (here: the law of its motion) between events.
  d.arrow({50, 96}, {610, 96}, kAxis);
  d.words({612, 114}, "virtual time", Align::kRight, color::soft, 12);
  const double times[] = {130, 255, 330, 470};
  const std::string fills[] = {color::b_wash, color::d_wash, color::c_wash, color::a_wash,
                               "#e6e0f0"};
  double from = 50;
  for (int i = 0; i <= 4; ++i) {
    const double to = i < 4 ? times[i] : 596;
    d.area({{from, 46}, {to, 46}, {to, 84}, {from, 84}}, fills[i], {color::line, 1});
    d.words({0.5 * (from + to), 70}, "s_" + std::to_string(i), Align::kMiddle, color::ink, 13.5);
    from = to;
  }
  for (int i = 0; i < 4; ++i) {
    d.line({times[i], 40}, {times[i], 102}, {color::a, 2.0});
    d.words({times[i], 34}, "e_" + std::to_string(i + 1), Align::kMiddle, color::a, 13);
  }
  // The queue.
  const char* const waiting[] = {"e_2", "e_3", "e_4"};
  for (int i = 0; i < 3; ++i) {
    const double x = 150 + 84 * i;
    d.area({{x, 142}, {x + 70, 142}, {x + 70, 172}, {x, 172}}, "#ffffff", {color::a, 1.5});
    d.words({x + 35, 162}, waiting[i], Align::kMiddle, color::a, 13);
  }
  d.words({136, 162}, "queue, by time", Align::kRight, color::ink, 12.5);
  d.arrow({185, 140}, {248, 106}, {color::a, 1.6});
  d.words({196, 126}, "take the first", Align::kRight, color::soft, 11.5);
  d.arrow({470, 106}, {404, 152}, {color::b, 1.6, "5 3"});
  d.words({450, 142}, "it may schedule later", Align::kLeft, color::b, 11.5);
  d.words({450, 158}, "events, never earlier ones", Align::kLeft, color::b, 11.5);
  d.caption({320, 206}, "between two events the state follows one law; only an event changes it");
  return d;
}

Drawing two_engines_and_their_faults() {
  Drawing d(640, 300);
  // Left: retroactive detection. One step of three bodies, two impacts found in it.
  const char* const names[] = {"A", "B", "C", "D"};
  for (int i = 0; i < 4; ++i) {
    const double y = 64 + 40 * i;
    d.words({26, y + 4}, names[i], Align::kMiddle, color::ink, 13, true);
    d.line({44, y}, {286, y}, {color::line, 1.2});
    d.line({44, y}, {150, y}, {color::b, 4});
    d.line({150, y}, {250, y}, {color::b, 2, "4 4"});
    d.words({366, y + 4}, names[i], Align::kMiddle, color::ink, 13, true);
    d.line({384, y}, {616, y}, {color::line, 1.2});
  }
  d.title({165, 30}, "retroactive detection");
  d.title({500, 30}, "conservative advancement");
  d.line({44, 48}, {44, 204}, kAxis);
  d.line({250, 48}, {250, 204}, kAxis);
  d.words({44, 222}, "t", Align::kMiddle, color::soft, 12);
  d.words({250, 222}, "t + h", Align::kMiddle, color::soft, 12);
  const auto impact = [&](double x, double y1, double y2, const std::string& ink,
                          const std::string& name, Point shift) {
    d.line({x, y1}, {x, y2}, {ink, 2.2});
    d.dot({x, y1}, ink);
    d.dot({x, y2}, ink);
    d.words(Point{x, 0.5 * (y1 + y2)} + shift, name, Align::kLeft, ink, 12);
  };
  impact(150, 64, 104, color::a, "1 found: first", {6, 4});
  impact(206, 104, 144, color::soft, "2 vanishes", {6, 4});
  impact(180, 64, 184, color::d, "", {0, 0});
  d.words({186, 170}, "3 is new: A", Align::kLeft, color::d, 11.5);
  d.words({186, 199}, "turned aside", Align::kLeft, color::d, 11.5);
  d.arrow({246, 236}, {154, 236}, {color::a, 1.8});
  d.words({200, 254}, "all four go back, D too", Align::kMiddle, color::a, 12);
  // Right: small steps of everybody towards a near miss.
  const double stops[] = {384, 440, 480, 508, 526, 538, 547, 554, 560, 566, 572};
  for (int i = 0; i < 4; ++i)
    for (int k = 1; k < 11; ++k)
      d.arrow({stops[k - 1], 64.0 + 40 * i}, {stops[k], 64.0 + 40 * i}, {color::b, 1.3});
  for (const double x : stops) d.line({x, 48}, {x, 204}, {color::line, 0.8});
  d.words({560, 98}, "gap of A and B → 0", Align::kRight, color::a, 11.5);
  d.words({500, 236}, "each bound stops all four;", Align::kMiddle, color::a, 12);
  d.words({500, 254}, "bounds shrink with the gap", Align::kMiddle, color::a, 12);
  d.caption({165, 284}, "work done and undone by all, at each impact");
  d.caption({500, 284}, "no work undone; very many small steps");
  return d;
}

Drawing messages_and_shared_effects() {
  Drawing d(640, 330);
  const char* const names[] = {"P_1", "P_2", "P_3"};
  d.title({165, 24}, "Jefferson: messages");
  d.title({490, 24}, "here: shared effects");
  for (int i = 0; i < 3; ++i) {
    const double y = 70 + 80 * i;
    d.words({22, y + 4}, names[i], Align::kMiddle, color::ink, 13, true);
    d.arrow({44, y}, {300, y}, kAxis);
    d.words({352, y + 4}, i == 0 ? "A" : i == 1 ? "B" : "C", Align::kMiddle, color::ink, 13, true);
    d.arrow({374, y}, {624, y}, kAxis);
  }
  // Left: a straggler at P_2 sends it back; it cancels what it had sent by anti-messages with the
  // same content.
  d.arrow({76, 70}, {104, 147}, {color::a, 2.4});
  d.words({128, 104}, "straggler", Align::kMiddle, color::a, 11.5);
  d.arrow({150, 150}, {186, 227}, {color::b, 2});
  d.arrow({190, 150}, {222, 73}, {color::b, 2});
  d.arrow({158, 150}, {194, 227}, {color::a, 1.6, "4 3"});
  d.arrow({198, 150}, {230, 73}, {color::a, 1.6, "4 3"});
  d.words({150, 196}, "+m_1", Align::kRight, color::b, 12);
  d.words({186, 190}, "−m_1", Align::kLeft, color::a, 12);
  d.words({192, 112}, "+m_2", Align::kRight, color::b, 12);
  d.words({226, 118}, "−m_2", Align::kLeft, color::a, 12);
  d.arrow({210, 160}, {110, 160}, {color::a, 1.8});
  d.words({258, 166}, "roll back", Align::kMiddle, color::a, 11.5);
  d.ball({104, 150}, 4, color::a);
  d.ball({190, 230}, 7, color::none, {color::a, 1.5});
  d.ball({226, 70}, 7, color::none, {color::a, 1.5});
  d.words({190, 256}, "+m and −m annihilate in the input queue", Align::kMiddle, color::soft, 11.5);
  // Right: an impact is one record known to both of its bodies.
  const auto effect = [&](double x, double y1, double y2, const std::string& ink,
                          const std::string& name, bool gone) {
    d.line({x, y1}, {x, y2}, {ink, 2.4, gone ? "4 3" : ""});
    d.dot({x, y1}, ink);
    d.dot({x, y2}, ink);
    d.words({x + 6, 0.5 * (y1 + y2) + 4}, name, Align::kLeft, ink, 12);
  };
  effect(430, 150, 230, color::a, "found late", false);
  effect(500, 70, 150, color::b, "effect of A and B", true);
  d.arrow({530, 162}, {436, 162}, {color::a, 1.8});
  d.arrow({560, 82}, {506, 82}, {color::a, 1.8});
  d.words({534, 167}, "B goes back", Align::kLeft, color::a, 11.5);
  d.words({564, 87}, "A, too", Align::kLeft, color::a, 11.5);
  d.words({490, 256}, "B forgets the effect; A knows it,", Align::kMiddle, color::soft, 11.5);
  d.words({490, 272}, "so A goes back to its stamp", Align::kMiddle, color::soft, 11.5);
  d.caption({165, 306}, "sender keeps a copy with the other sign");
  d.caption({490, 306}, "both hold the same record");
  return d;
}

Drawing active_pairs() {
  Drawing d(640, 290);
  const struct {
    const char* name;
    Point from, to;
    double radius;
    std::string fill, ink;
  } bodies[] = {{"A", {70, 180}, {180, 110}, 18, color::a_wash, color::a},
                {"B", {262, 90}, {190, 172}, 18, color::b_wash, color::b},
                {"C", {330, 70}, {372, 130}, 18, color::d_wash, color::d}};
  for (const auto& body : bodies) {
    const double x0 = std::min(body.from.x, body.to.x) - body.radius,
                 x1 = std::max(body.from.x, body.to.x) + body.radius,
                 y0 = std::min(body.from.y, body.to.y) - body.radius,
                 y1 = std::max(body.from.y, body.to.y) + body.radius;
    d.area({{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}, body.fill + "66", {body.ink, 1.2, "5 3"});
    d.ball(body.from, body.radius, body.fill, {body.ink, 1.3});
    d.ball(body.to, body.radius, "#ffffff", {body.ink, 1.3});
    d.arrow(body.from, body.to, {body.ink, 1.6});
    d.words(body.from + Point{-8, 4}, body.name, Align::kMiddle, body.ink, 13, true);
  }
  // Their intervals on the x axis.
  d.arrow({40, 232}, {420, 232}, kAxis);
  d.words({424, 236}, "x", Align::kLeft, color::soft, 12);
  double y = 242;
  for (const auto& body : bodies) {
    const double x0 = std::min(body.from.x, body.to.x) - body.radius,
                 x1 = std::max(body.from.x, body.to.x) + body.radius;
    d.line({x0, y}, {x1, y}, {body.ink, 3});
    d.dot({x0, y}, body.ink);
    d.dot({x1, y}, body.ink);
    y += 9;
  }
  d.words({40, 30}, "full: at global virtual time · empty: at the local virtual time", Align::kLeft,
          color::soft, 11.5);
  d.words({450, 70}, "A and B: boxes overlap:", Align::kLeft, color::ink, 12);
  d.words({450, 87}, "an active pair, with a check", Align::kLeft, color::ink, 12);
  d.words({450, 116}, "C: no pair, no check", Align::kLeft, color::d, 12);
  d.words({450, 158}, "six heaps a body:", Align::kLeft, color::ink, 12);
  d.words({450, 175}, "min and max of x, y, z over", Align::kLeft, color::ink, 12);
  d.words({450, 192}, "its states; the top is a face", Align::kLeft, color::ink, 12);
  d.words({450, 209}, "of the box", Align::kLeft, color::ink, 12);
  d.caption({230, 284}, "intervals on x: smallest and largest over the states");
  return d;
}

Drawing group_rollback() {
  Drawing d(640, 240);
  const auto bars = [&](double left, bool all) {
    const char* const names[] = {"A", "B", "C"};
    for (int i = 0; i < 3; ++i) {
      const double y = 66 + 42 * i, end = all || i == 2 ? 130 : 230;
      d.words({left, y + 5}, names[i], Align::kMiddle, color::ink, 13, true);
      d.line({left + 16, y}, {left + end, y}, {color::b, 8});
      if (end < 230) d.line({left + end + 4, y}, {left + 230, y}, {color::line, 8, "2 8"});
    }
    d.area({{left + 20, 50},
            {left + (all ? 130 : 116), 50},
            {left + (all ? 130 : 116), 166},
            {left + 20, 166}},
           "#ffffff00", {color::d, 1.6, "6 4"});
    d.line({left + 130, 40}, {left + 130, 176}, {color::a, 1.8});
    d.words({left + 130, 34}, "t_c", Align::kMiddle, color::a, 13);
  };
  bars(30, false);
  bars(350, true);
  d.words({160, 194}, "the member that was hit goes back;", Align::kMiddle, color::ink, 12);
  d.words({160, 210}, "the group ends at t_c for it alone", Align::kMiddle, color::ink, 12);
  d.words({480, 194}, "all members go back, and the group", Align::kMiddle, color::ink, 12);
  d.words({480, 210}, "is formed anew from t_c on", Align::kMiddle, color::ink, 12);
  d.caption({160, 232}, "the paper");
  d.caption({480, 232}, "here");
  return d;
}

}  // namespace

std::vector<Figure> figures_of_a4() {
  return {{"discrete_events", discrete_events},
          {"two_engines_and_their_faults", two_engines_and_their_faults},
          {"messages_and_shared_effects", messages_and_shared_effects},
          {"active_pairs", active_pairs},
          {"group_rollback", group_rollback}};
}

}  // namespace tumble::handouts
