#include "page/page_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>

#include "lumivox/results/text.h"
#include "page/page_assets.h"

namespace lumivox::page {

std::string escaped(const std::string& text) {
  std::string safe;
  safe.reserve(text.size());
  for (const char c : text) switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      case '\'':
        safe += "&#39;";
        break;
      default:
        safe += c;
    }
  return safe;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

std::string number(double value) {
  return std::isfinite(value) ? fmt::format("{:.3g}", value) : std::string("-");
}

std::string oneDigit(double value) {
  if (!(std::abs(value) >= 10.0) || !std::isfinite(value)) return fmt::format("{:.1g}", value);
  const double decade = std::pow(10.0, std::floor(std::log10(std::abs(value))));
  return fmt::format("{:.0f}", std::round(value / decade) * decade);
}

std::string withUncertainty(const Measured& measured) {
  if (!std::isfinite(measured.value)) return "-";
  return fmt::format("{:.3g} <span class=\"uncertainty\">&plusmn; {}</span>", measured.value,
                     oneDigit(measured.uncertainty));
}

std::string withQuartiles(const TimingStatistics& time) {
  if (time.repeats == 0) return "-";
  return fmt::format("{} <span class=\"uncertainty\">[{}, {}]</span>", formatMilliseconds(time.median),
                     formatMilliseconds(time.lowerQuartile), formatMilliseconds(time.upperQuartile));
}

std::string percent(double share) {
  return fmt::format("{:.1f} %", 100.0 * share);
}

std::string componentTitle(const std::string& component) {
  if (component == "final") return "Whole picture";
  std::string title = component;
  std::replace(title.begin(), title.end(), '_', ' ');
  title.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(title.front())));
  return title;
}

std::string dataBlock(const std::string& id, const std::string& json) {
  return "<script type=\"application/json\" id=\"" + id + "\">" + replaced(json, "<", "\\u003c") +
         "</script>\n";
}

std::string wholePage(const std::string& title, const std::string& styles, const std::string& body,
                      const std::string& chartLibrary, const std::string& scripts) {
  std::string html =
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
      title + "</title>\n<style>";
  html += kPageStyle + styles + "</style>\n</head>\n<body>\n" + body;
  html += "<script>" + replaced(chartLibrary, "</script", "<\\/script") + "</script>\n<script>" +
          kPageHelpers + scripts + "</script>\n</body>\n</html>\n";
  return html;
}

}  // namespace lumivox::page
