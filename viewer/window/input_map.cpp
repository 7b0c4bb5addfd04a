#include "viewer/window/input_map.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <array>

namespace pagoda::viewer {
namespace {

struct Binding {
    int key, modifiers;
    Command command;
};

constexpr int kIgnored = GLFW_MOD_CAPS_LOCK | GLFW_MOD_NUM_LOCK;

constexpr std::array kBindings = {
    Binding{GLFW_KEY_F, 0, Command::FrameAll},
    Binding{GLFW_KEY_V, 0, Command::FramePick},
    Binding{GLFW_KEY_H, 0, Command::Home},
    Binding{GLFW_KEY_1, 0, Command::ViewFront},
    Binding{GLFW_KEY_2, 0, Command::ViewBack},
    Binding{GLFW_KEY_3, 0, Command::ViewLeft},
    Binding{GLFW_KEY_4, 0, Command::ViewRight},
    Binding{GLFW_KEY_5, 0, Command::ViewTop},
    Binding{GLFW_KEY_6, 0, Command::ViewBottom},
    Binding{GLFW_KEY_7, 0, Command::ViewIsometric},
    Binding{GLFW_KEY_O, 0, Command::ModeOrbit},
    Binding{GLFW_KEY_G, 0, Command::ModeFly},
    Binding{GLFW_KEY_K, 0, Command::ModeWalk},
    Binding{GLFW_KEY_T, 0, Command::NextStrategy},
    Binding{GLFW_KEY_COMMA, 0, Command::FinerTau},
    Binding{GLFW_KEY_PERIOD, 0, Command::CoarserTau},
    Binding{GLFW_KEY_C, 0, Command::NextColouring},
    Binding{GLFW_KEY_X, 0, Command::ToggleWireframe},
    Binding{GLFW_KEY_Z, 0, Command::ToggleFreeze},
    Binding{GLFW_KEY_I, 0, Command::ToggleHud},
    Binding{GLFW_KEY_TAB, 0, Command::ToggleSteering},
    Binding{GLFW_KEY_M, 0, Command::ToggleLoading},
    Binding{GLFW_KEY_N, 0, Command::ToggleSection},
    Binding{GLFW_KEY_B, 0, Command::ToggleObjects},
    Binding{GLFW_KEY_DELETE, 0, Command::HideObject},
    Binding{GLFW_KEY_DELETE, GLFW_MOD_SHIFT, Command::IsolateObject},
    Binding{GLFW_KEY_U, 0, Command::ShowAllObjects},
    Binding{GLFW_KEY_F1, 0, Command::ToggleHelp},
    Binding{GLFW_KEY_SLASH, 0, Command::ToggleHelp},
    Binding{GLFW_KEY_SLASH, GLFW_MOD_SHIFT, Command::ToggleHelp},
    Binding{GLFW_KEY_P, 0, Command::Screenshot},
    Binding{GLFW_KEY_F12, 0, Command::Screenshot},
    Binding{GLFW_KEY_C, GLFW_MOD_CONTROL, Command::CopyCamera},
    Binding{GLFW_KEY_V, GLFW_MOD_CONTROL, Command::PasteCamera},
    Binding{GLFW_KEY_R, 0, Command::RecordPath},
    Binding{GLFW_KEY_R, GLFW_MOD_SHIFT, Command::ReplayPath},
    Binding{GLFW_KEY_ESCAPE, 0, Command::Dismiss},
    Binding{GLFW_KEY_Q, GLFW_MOD_CONTROL, Command::Quit},
};

constexpr std::array kKeyLines = {
    KeyLine{nullptr, "Move"},
    KeyLine{"Left drag", "orbit about what is under the cursor; look, in fly and walk"},
    KeyLine{"Right or middle drag", "pan (also Shift + left)"},
    KeyLine{"Wheel", "zoom towards the cursor; speed, in fly and walk"},
    KeyLine{"Ctrl + left drag", "zoom"},
    KeyLine{"W A S D  Q E", "move; down and up"},
    KeyLine{"Shift, Ctrl", "faster, slower"},
    KeyLine{"O  G  K", "orbit, fly, walk"},
    KeyLine{"F  H", "frame all; home"},
    KeyLine{"1 ... 7", "front, back, left, right, top, bottom, isometric"},
    KeyLine{nullptr, "Ask"},
    KeyLine{"Click", "what is there: object, exact position, node, and why it is not finer"},
    KeyLine{"V", "frame the node that was clicked"},
    KeyLine{"Z", "freeze what is drawn, and fly away from it"},
    KeyLine{"C", "colours: the model's, by level, node, error"},
    KeyLine{"X", "wireframe"},
    KeyLine{nullptr, "Objects"},
    KeyLine{"B", "the tree of objects: find, hide, leave alone"},
    KeyLine{"Delete, Shift + Delete", "hide what was clicked; hide all but that"},
    KeyLine{"U", "show all again"},
    KeyLine{"N", "cut along a plane"},
    KeyLine{nullptr, "Steer"},
    KeyLine{"Tab", "panel: strategy, tau, budgets, frame rate"},
    KeyLine{"T", "next strategy"},
    KeyLine{",  .", "finer, coarser (tau)"},
    KeyLine{"I", "numbers on, off"},
    KeyLine{"M", "what was read, by codec; a simulated disk"},
    KeyLine{nullptr, "Keep"},
    KeyLine{"P", "screenshot (PNG)"},
    KeyLine{"Ctrl + C, Ctrl + V", "copy, paste the camera (JSON)"},
    KeyLine{"R, Shift + R", "record a camera path; replay it"},
    KeyLine{"Drop a file", "opens that database or model"},
    KeyLine{"Esc", "close what lies on top; cancel what is being opened"},
    KeyLine{"Ctrl + Q", "quit"},
};

}  // namespace

std::optional<Command> commandOf(int key, int modifiers) {
    const int wanted = modifiers & ~kIgnored;
    const auto* const found =
        std::find_if(kBindings.begin(), kBindings.end(),
                     [&](const Binding& b) { return b.key == key && b.modifiers == wanted; });
    if (found == kBindings.end()) return std::nullopt;
    return found->command;
}

bool isMoveKey(int key) {
    constexpr std::array kKeys = {GLFW_KEY_W, GLFW_KEY_A, GLFW_KEY_S,
                                  GLFW_KEY_D, GLFW_KEY_Q, GLFW_KEY_E};
    return std::find(kKeys.begin(), kKeys.end(), key) != kKeys.end();
}

MoveKeys moveKeysOf(const std::set<int>& held) {
    const auto isHeld = [&](int key) { return held.contains(key); };
    MoveKeys keys{};
    keys.forward = isHeld(GLFW_KEY_W);
    keys.back = isHeld(GLFW_KEY_S);
    keys.left = isHeld(GLFW_KEY_A);
    keys.right = isHeld(GLFW_KEY_D);
    keys.down = isHeld(GLFW_KEY_Q);
    keys.up = isHeld(GLFW_KEY_E);
    keys.fast = isHeld(GLFW_KEY_LEFT_SHIFT) || isHeld(GLFW_KEY_RIGHT_SHIFT);
    keys.slow = isHeld(GLFW_KEY_LEFT_CONTROL) || isHeld(GLFW_KEY_RIGHT_CONTROL);
    return keys;
}

std::optional<DragKind> dragOf(int button, int modifiers, NavigationMode mode) {
    if (button == GLFW_MOUSE_BUTTON_RIGHT || button == GLFW_MOUSE_BUTTON_MIDDLE) {
        return DragKind::Pan;
    }
    if (button != GLFW_MOUSE_BUTTON_LEFT) return std::nullopt;
    if ((modifiers & GLFW_MOD_SHIFT) != 0) return DragKind::Pan;
    if ((modifiers & GLFW_MOD_CONTROL) != 0) return DragKind::Zoom;
    return mode == NavigationMode::Orbit ? DragKind::Orbit : DragKind::Look;
}

bool isPickButton(int button) {
    return button == GLFW_MOUSE_BUTTON_LEFT;
}

std::span<const KeyLine> keyLines() {
    return kKeyLines;
}

}  // namespace pagoda::viewer
