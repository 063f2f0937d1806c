"""Weld two seams on a plate."""


def weld(torch):
    torch.move_to(10.0, 5.0)
    torch.switch(True)
    torch.move_by(30.0, 0.0)
    torch.switch(False)
    torch.move_by(0.0, 20.0)
    torch.switch(True)
    torch.move_by(-30.0, 0.0)
    torch.switch(False)
    return torch.where()
