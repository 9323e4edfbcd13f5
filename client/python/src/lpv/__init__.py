"""Client of lpvd, a lighting service.

    import lpv

    with lpv.connect("localhost:50051") as client:
        session = client.create_session(grid=32)
        editor = session.join()
        editor.apply(lpv.scene.light("lamp", lpv.scene.quad(.5), radiance=(20, 18, 14)), lpv.scene.fit_grid())
        volume = session.volume()          # volume.coefficients, volume.fluence(): numpy arrays

lpv.aio has the same as coroutines, lpv.scene what edits are made of, lpv.v1 the messages.
"""

from lpv import aio, scene
from lpv.blocking import Client, Editor, Session, connect
from lpv.compact import Malformed
from lpv.errors import Error
from lpv.results import Frame, Probe, Volume

__all__ = ["Client", "Editor", "Error", "Frame", "Malformed", "Probe", "Session", "Volume", "aio", "connect", "scene"]
