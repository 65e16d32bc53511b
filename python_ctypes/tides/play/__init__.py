"""A window to fly in: a scene and the events that its camera sees, in a page on this machine.

   python -m tides.play scene.spz          # or a run file; --help lists options

Behind the page is a live run (`tides.Live`), so that the window shows a run's own events. `record` keeps path, run file and
events together, and shows the command that makes the events again. It needs the websockets package: pip install
tides[play].

flight.py flies the camera, world.py runs and records, server.py serves the page page.html.
"""

from .flight import Controls, Flight
from .world import World, event_hash

__all__ = ["Controls", "event_hash", "Flight", "World"]
