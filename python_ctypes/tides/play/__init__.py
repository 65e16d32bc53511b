"""A window to fly in: a scene and the events that its camera sees, in a page on this machine.

    python -m tides.play scene.spz          # or a run file; --help lists what can be said

Behind the page is a live run (`tides.Live`), so that what is seen is what a run gives: `record` keeps path, run file and events
together, and shows the line that makes the events again. It needs the websockets package: pip install tides[play].

flight.py flies the camera, world.py runs and records, server.py is the page's other end, page.html the page.
"""

from .flight import Controls, Flight
from .world import World, event_hash

__all__ = ["Controls", "event_hash", "Flight", "World"]
