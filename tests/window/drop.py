"""Drops a file on a window as a file manager does: the XDND protocol, version 5, over libX11.

    drop.py WINDOW FILE        WINDOW: the X window's number; DISPLAY says where"""
import ctypes
import ctypes.util
import sys
from pathlib import Path

CLIENT_MESSAGE, SELECTION_REQUEST, SELECTION_NOTIFY = 33, 30, 31
Long, Int, Pointer = ctypes.c_long, ctypes.c_int, ctypes.c_void_p
HEAD = [("type", Int), ("serial", ctypes.c_ulong), ("send_event", Int), ("display", Pointer)]


class ClientMessage(ctypes.Structure):
    _fields_ = HEAD + [("window", Long), ("message_type", Long), ("format", Int), ("data", Long * 5)]


class SelectionRequest(ctypes.Structure):
    _fields_ = HEAD + [("owner", Long), ("requestor", Long), ("selection", Long), ("target", Long),
                       ("property", Long), ("time", Long)]


class Selection(ctypes.Structure):
    _fields_ = HEAD + [("requestor", Long), ("selection", Long), ("target", Long),
                       ("property", Long), ("time", Long)]


class Event(ctypes.Union):
    _fields_ = [("type", Int), ("client", ClientMessage), ("request", SelectionRequest),
                ("selection", Selection), ("pad", Long * 24)]


def drop(target, path):
    x = ctypes.CDLL(ctypes.util.find_library("X11"))
    x.XOpenDisplay.restype = Pointer
    for name in ("XDefaultRootWindow", "XInternAtom", "XCreateSimpleWindow"):
        getattr(x, name).restype = Long
    display = Pointer(x.XOpenDisplay(None))
    root = Long(x.XDefaultRootWindow(display))
    source = x.XCreateSimpleWindow(display, root, 0, 0, 1, 1, 0, Long(0), Long(0))

    def atom(name):
        return x.XInternAtom(display, name.encode(), 0)

    def tell(name, *data):
        event = Event()
        event.client = ClientMessage(type=CLIENT_MESSAGE, window=target, message_type=atom(name),
                                     format=32, data=(Long * 5)(source, *data))
        x.XSendEvent(display, Long(target), 0, Long(0), ctypes.byref(event))

    selection, uris = atom("XdndSelection"), atom("text/uri-list")
    x.XSetSelectionOwner(display, Long(selection), Long(source), Long(0))
    tell("XdndEnter", 5 << 24, uris, 0, 0)
    tell("XdndPosition", 0, (100 << 16) | 100, 0, atom("XdndActionCopy"))
    tell("XdndDrop", 0, 0, 0, 0)
    event = Event()
    while True:
        x.XNextEvent(display, ctypes.byref(event))
        if event.type == SELECTION_REQUEST:
            request = event.request
            text = (Path(path).resolve().as_uri() + "\r\n").encode()
            x.XChangeProperty(display, Long(request.requestor), Long(request.property),
                              Long(request.target), 8, 0, text, len(text))
            answer = Event()
            answer.selection = Selection(type=SELECTION_NOTIFY, requestor=request.requestor,
                                         selection=request.selection, target=request.target,
                                         property=request.property, time=request.time)
            x.XSendEvent(display, Long(request.requestor), 0, Long(0), ctypes.byref(answer))
            x.XFlush(display)
        elif event.type == CLIENT_MESSAGE and event.client.message_type == atom("XdndFinished"):
            return


if __name__ == "__main__":
    drop(int(sys.argv[1]), sys.argv[2])
