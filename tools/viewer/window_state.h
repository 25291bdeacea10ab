// The internal state of the window, shared by its sources.
#pragma once

#include <epoxy/gl.h>
// After epoxy, which declares OpenGL.
#include <GLFW/glfw3.h>
#include <imgui.h>

#include <chrono>
#include <map>

#include "viewer/panels.h"
#include "viewer/window.h"

namespace lumivox::viewer {

/// A picture in a texture of the window's OpenGL context.
class ScreenTexture {
 public:
  ~ScreenTexture() { glDeleteTextures(1, &name_); }
  void show(const Picture& picture) {
    if (name_ == 0) glGenTextures(1, &name_);
    glBindTexture(GL_TEXTURE_2D, name_);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    if (picture.width != width_ || picture.height != height_) {
      glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, picture.width, picture.height, 0, GL_RGB, GL_UNSIGNED_BYTE,
                   picture.bytes.data());
      glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
      glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
      width_ = picture.width;
      height_ = picture.height;
    } else {
      glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width_, height_, GL_RGB, GL_UNSIGNED_BYTE,
                      picture.bytes.data());
    }
  }
  ImTextureID id() const { return reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(name_)); }
  int width() const { return width_; }
  int height() const { return height_; }

 private:
  GLuint name_ = 0;
  int width_ = 0, height_ = 0;
};

struct KeyStatement {
  int key;
  bool control;
  const char *name, *statement, *meaning;
};
/// The statements of keys, except the movement keys.
const std::vector<KeyStatement>& keyStatements();
/// The other keys that scripts may press: those that move, turn and navigate in panels.
const std::map<std::string, int>& heldKeys();

struct Rectangle {
  ImVec2 low{0, 0}, high{0, 0};
};

struct Window::State {
  WindowOptions options;
  GLFWwindow* window = nullptr;
  float scale = 1.0f;
  bool touched = true;  ///< an input or display event came since the last drawing
  std::unique_ptr<ScreenTexture> texture;
  Session* session = nullptr;
  std::vector<Panel> panels;
  std::string openPanel = "look", wantedPanel;
  std::string moves;  ///< the control that the mouse drags
  bool showsHelp = false, showsPanels = true;
  bool minimised = false, picturesKeyboard = false;  ///< whether arrows turn the view
  float panelWidth = 420.0f;                         ///< pixels at a scale of 1
  std::string focus;                                 ///< the part that gets the keyboard in the next frame
  std::string layout;                                ///< as last read or written
  std::map<std::string, Rectangle> controls;         ///< of this frame, by "panel/row"
  Rectangle image;                                   ///< the picture in the window

  std::vector<Action> script;
  std::size_t done = 0;
  std::chrono::steady_clock::time_point waitsSince;
  bool waits = false;
  /// A click by a script takes three frames: move, press, release.
  struct Click {
    ImVec2 at;
    int frame = 0;
  };
  std::optional<Click> click;
  /// A key that a script presses for some frames.
  struct Press {
    int key = 0, frame = 0;
  };
  std::optional<Press> press;
  int soon = 3;  ///< frames to draw without any event: ImGui needs some to settle

  void act(const std::string& statements);
  void key(const KeyStatement& key);
  void walk(double seconds);
  void look(double seconds);
  void listen();
  void rescale(float to);
  void minimise(bool away);
  bool stepSession(double seconds, bool scripted);
  void drawFrame(double seconds);
  void readLayout();
  void writeLayout();
  std::string layoutText() const;
  void draw();
  void drawPicture(const ImVec2& low, const ImVec2& size);
  void drawPanels();
  void drawRow(const Panel& panel, const Row& row);
  void changeBy(const std::string& control, const std::string& statements);
  int drawSteps(const std::string& name);
  void drawNumber(const Row& row, const std::string& name);
  void drawTriple(const Row& row, const std::string& name);
  void drawResets(const Row& row, const std::string& name);
  void drawQuestion();
  void drawChoice(const Panel& panel, const Row& row);
  void drawMarks(const Row& row);
  void drawBars(const Row& row, const ImVec2& corner, float width) const;
  void drawStacks(const Row& row, const ImVec2& corner, float width) const;
  void drawChart(const Row& row, const ImVec2& corner, float width);
  float legendHeight() const;
  void drawLegends(const ImVec2& bottom, float width) const;
  void drawHelp();
  void drawProblem(const ImVec2& at, float width);
  void feedClick();
  void feedPress();
  bool busyWithHands() const { return click.has_value() || press.has_value(); }
  bool advanceScript();
  bool doInWindow(const Action& action);
  bool waitIsOver(const Action& action);
  void shoot(const std::filesystem::path& file);
  void resize(int width, int height);
  void randomActions(int count);
};

}  // namespace lumivox::viewer
