%%%
  VERSION:1
  LANGUAGE:ENGLISH
%%%
MODULE Pick
  ! Take the box from the conveyor and set it down on the table. The seventh joint is the first external axis.
  CONST jointtarget jOverConveyor:=[[0,26,180,-78,0,-76],[90,9E9,9E9,9E9,9E9,9E9]];
  CONST jointtarget jOverTable:=[[-145,26,180,-78,0,-76],[90,9E9,9E9,9E9,9E9,9E9]];
  CONST jointtarget jHome:=[[0,15,180,-130,0,55],[90,9E9,9E9,9E9,9E9,9E9]];
  ! where the fingers hold the box, in the frames of conveyor and table
  CONST robtarget pBox:=[[550,200,30],[0,0.707107,0.707107,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pPlace:=[[-400,150,31.5],[0,0.707107,-0.707107,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  PERS tooldata tGrip:=[TRUE,[[0,0,0],[1,0,0,0]],[0.9,[0,0,50],[1,0,0,0],0,0,0]];
  PERS wobjdata wConveyor:=[FALSE,TRUE,"",[[0,0,100],[1,0,0,0]],[[0,0,0],[1,0,0,0]]];
  PERS wobjdata wTable:=[FALSE,TRUE,"",[[0,0,-140],[1,0,0,0]],[[0,0,0],[1,0,0,0]]];

  PROC main()
    ConfL\Off;
    Reset doGrip;
    MoveAbsJ jOverConveyor\NoEOffs, v500, fine, tGrip;
    MoveL Offs(pBox,0,0,150), v250, fine, tGrip\WObj:=wConveyor;
    MoveL pBox, v250, fine, tGrip\WObj:=wConveyor;
    Set doGrip;
    WaitTime 0.8;
    MoveL Offs(pBox,0,0,150), v250, fine, tGrip\WObj:=wConveyor;
    IF TestDI(diHolding) THEN
      SetDown;
    ELSE
      Reset doGrip;
    ENDIF
    MoveAbsJ jHome\NoEOffs, v500, fine, tGrip;
  ENDPROC

  PROC SetDown()
    MoveAbsJ jOverTable\NoEOffs, v500, fine, tGrip;
    MoveL Offs(pPlace,0,0,150), v250, fine, tGrip\WObj:=wTable;
    MoveL pPlace, v250, fine, tGrip\WObj:=wTable;
    Reset doGrip;
    WaitTime 0.8;
    MoveL Offs(pPlace,0,0,150), v250, fine, tGrip\WObj:=wTable;
  ENDPROC
ENDMODULE
