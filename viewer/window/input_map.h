// input_map.h: which key, button or wheel does what: the one table that input and the overlay of
// keys share. Pure functions. Numbers of keys and buttons are GLFW's.
#pragma once

#include "viewer/navigation.h"

#include <optional>
#include <set>
#include <span>

namespace pagoda::viewer {

enum class Command {
    FrameAll,
    FramePick,
    Home,
    ViewFront,
    ViewBack,
    ViewLeft,
    ViewRight,
    ViewTop,
    ViewBottom,
    ViewIsometric,
    ModeOrbit,
    ModeFly,
    ModeWalk,
    NextStrategy,
    FinerTau,
    CoarserTau,
    NextColouring,
    ToggleWireframe,
    ToggleFreeze,
    ToggleHud,
    ToggleSteering,
    ToggleHelp,
    ToggleLoading,
    ToggleSection,
    ToggleObjects,
    HideObject,
    IsolateObject,
    ShowAllObjects,
    Screenshot,
    CopyCamera,
    PasteCamera,
    RecordPath,
    ReplayPath,
    Dismiss,
    Quit,
};

[[nodiscard]] std::optional<Command> commandOf(int key, int modifiers);
// `held`: keys that are down now.
[[nodiscard]] MoveKeys moveKeysOf(const std::set<int>& held);
[[nodiscard]] bool isMoveKey(int key);
[[nodiscard]] std::optional<DragKind> dragOf(int button, int modifiers, NavigationMode mode);
// What a click with this button does is to pick.
[[nodiscard]] bool isPickButton(int button);

// Lines of the overlay; a line without `keys` is a heading.
struct KeyLine {
    const char* keys;
    const char* what;
};
[[nodiscard]] std::span<const KeyLine> keyLines();

}  // namespace pagoda::viewer
